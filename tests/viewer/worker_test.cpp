// SPDX-License-Identifier: Apache-2.0
// The renderer's thread: what it shows is what `render --device gl` gives, and it can be given up.
#include "app/viewer/worker.h"

#include "app/viewer/files.h"
#include "formats/files/error.h"
#include "render/gpu/render.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>

namespace nearfield::viewer {
namespace {

/// Waits for a worker's progress.
class Watched {
  public:
    Worker worker{[this] {
        const std::lock_guard lock(mutex_);
        changed_.notify_all();
    }};

    template <typename Condition>
    Progress wait_for(const Condition& condition) {
        std::unique_lock lock(mutex_);
        while (!condition(worker.progress()))
            changed_.wait_for(lock, std::chrono::milliseconds(50));
        return worker.progress();
    }
    Progress wait_for_final(int serial) {
        return wait_for([serial](const Progress& progress) {
            return !progress.error.empty() ||
                   (progress.frame && progress.is_final && progress.frame->serial == serial);
        });
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
};

Request small_request(int serial) {
    Request request;
    request.document = document_of(test::with_second_lamp(test::uneven_scene()), "");
    request.camera = request.document.scene->cameras.front();
    request.size_px = {120, 90};
    request.serial = serial;
    return request;
}

std::vector<float> mixed_radiance(const Frame& frame, const Document& document) {
    return mix(frame, gains_of(frame, document)).radiance;
}

std::vector<float> rendered_radiance(const Request& request) {
    Scene scene = edited_scene(request.document);
    scene.cameras = {request.camera};
    render::RenderOptions options;
    options.size_px = request.size_px;
    options.shows_lamps = true;
    return test::layer(render::render_gl(scene, options).picture, "").values;
}

TEST(ViewerWorker, ThePictureIsTheRenderersBitByBit) {
    const Request request = small_request(1);
    const std::vector<float> rendered = rendered_radiance(request);
    Watched watched;
    watched.worker.show(request);
    const Progress progress = watched.wait_for_final(1);
    ASSERT_EQ(progress.error, "");
    EXPECT_EQ(progress.frame->size_px, request.size_px);
    EXPECT_EQ(mixed_radiance(*progress.frame, request.document), rendered);
}

TEST(ViewerWorker, DimAndTintAskForNoRendering) {
    const Request request = small_request(1);
    const auto with = [&](const Edit& edit) {
        Request changed = request;
        changed.document = edited(request.document, edit);
        return changed;
    };
    EXPECT_TRUE(is_lit_alike(request, with(SetDim{0, 0.3})));
    EXPECT_TRUE(is_lit_alike(request, with(SetTint{1, {1.0F, 0.5F, 0.25F}})));
    EXPECT_TRUE(is_lit_alike(request, with(SetOn{0, false})));
    EXPECT_FALSE(is_lit_alike(with(SetOn{0, false}), request));
    EXPECT_FALSE(is_lit_alike(request, with(Aim{0, {0.0, 0.0, 0.0}})));
    EXPECT_FALSE(is_lit_alike(request, with(Duplicate{0, {0.1, 0.0, 0.0}})));
}

/// What was rendered of the one document, mixed as the other, against the other's own picture.
void expect_mixed(const Document& as_rendered, const Document& wanted) {
    Request request = small_request(1);
    request.camera = as_rendered.scene->cameras.front();
    request.document = wanted;
    const std::vector<float> rendered = rendered_radiance(request);
    request.document = as_rendered;
    Watched watched;
    watched.worker.show(request);
    const Progress progress = watched.wait_for_final(1);
    ASSERT_EQ(progress.error, "");
    const std::vector<float> mixed = mixed_radiance(*progress.frame, wanted);
    const float brightest = *std::max_element(rendered.begin(), rendered.end());
    ASSERT_GT(brightest, 0.0F);
    for (std::size_t k = 0; k < mixed.size(); ++k)
        ASSERT_NEAR(mixed[k], rendered[k], 1e-6F * brightest);  // the same light, rounded elsewhere
}

TEST(ViewerWorker, MixedLightIsRenderedLight) {
    const Document document = small_request(1).document;
    expect_mixed(document, edited(document, SetDim{0, 0.3}));
    // Without shadows: the maps' places depend on the lamp's colors.
    const Document plain = document_of(test::plain_scene(), "");
    expect_mixed(plain, edited(plain, SetTint{0, {1.0F, 0.5F, 0.3F}}));
}

TEST(ViewerWorker, TheNewestRequestWins) {
    std::vector<Request> requests = {small_request(0)};
    for (int k = 1; k <= 40; ++k) {
        Request request = requests.back();
        glm::dmat4 pose = request.document.lamps[0].luminaire.world_from_luminaire;
        pose[3].x += 0.002;
        request.document = edited(request.document, SetPose{0, pose});
        request.serial = k;
        requests.push_back(request);
    }
    const std::vector<float> rendered = rendered_radiance(requests.back());
    Watched watched;
    for (const Request& request : requests)
        watched.worker.show(request);
    const Progress progress = watched.wait_for_final(40);
    EXPECT_EQ(mixed_radiance(*progress.frame, requests.back().document), rendered);
}

TEST(ViewerWorker, ALampThatCannotBeReadLeavesTheLastPicture) {
    Watched watched;
    Request request = small_request(1);
    watched.worker.show(request);
    const std::shared_ptr<const Frame> good = watched.wait_for_final(1).frame;
    std::ofstream("broken.lightfield.exr") << "nothing";
    LuminaireInstance broken = request.document.lamps[0].luminaire;
    broken.path = "broken.lightfield.exr";
    Request bad = request;
    bad.document = edited(request.document, Add{broken});
    bad.serial = 2;
    watched.worker.show(bad);
    const Progress after =
        watched.wait_for([](const Progress& progress) { return !progress.error.empty(); });
    EXPECT_NE(after.error.find("broken.lightfield.exr"), std::string::npos) << after.error;
    EXPECT_TRUE(after.frame);
    request.serial = 3;
    watched.worker.show(request);  // and it goes on
    const Progress again = watched.wait_for([](const Progress& progress) {
        return progress.frame && progress.frame->serial == 3 && progress.is_final;
    });
    EXPECT_EQ(again.error, "");
    EXPECT_EQ(mixed_radiance(*again.frame, request.document),
              mixed_radiance(*good, request.document));
}

TEST(ViewerWorker, DialsSayWhatTheyCostAndGive) {
    Watched watched;
    watched.worker.try_dials(small_request(1));
    const Progress progress = watched.wait_for(
        [](const Progress& now) { return !now.trials.empty() || !now.error.empty(); });
    ASSERT_EQ(progress.error, "");
    ASSERT_EQ(progress.trials.size(), dials().size());
    EXPECT_EQ(progress.trials.back().error_rel, 0.0);
    EXPECT_GT(progress.trials.front().error_rel, 0.0);
    for (const DialTrial& trial : progress.trials)
        EXPECT_GT(trial.time_s, 0.0);
}

TEST(ViewerQuality, DraftsFollowTheirTime) {
    EXPECT_EQ(next_draft_divisor(8, 0.07, 0.045), 10);
    EXPECT_EQ(next_draft_divisor(8, 0.4, 0.045), 16);
    EXPECT_EQ(next_draft_divisor(16, 0.2, 0.045), 16);
    EXPECT_EQ(next_draft_divisor(8, 0.040, 0.045), 8);
    EXPECT_EQ(next_draft_divisor(8, 0.01, 0.045), 7);
    EXPECT_EQ(next_draft_divisor(1, 0.0, 0.045), 1);
    EXPECT_EQ(stages_of(kDefaultDial, 8).back(), dials()[kDefaultDial].quality);
    EXPECT_EQ(stages_of(0, 1).size(), 2U);  // the latter says how wrong it is
}

}  // namespace
}  // namespace nearfield::viewer
