// SPDX-License-Identifier: Apache-2.0
// What is recorded is what the scenes beside it give without a window.
#include "app/viewer/record.h"

#include "formats/files/error.h"
#include "formats/files/image.h"
#include "render/film.h"
#include "render/gpu/render.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

namespace nearfield::viewer {
namespace {

namespace fs = std::filesystem;

constexpr glm::ivec2 kSize(64, 48);
constexpr double kExposure_ev = 4.0;

std::string bytes_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// A viewer of a scene's file, looking through its first camera.
Viewer opened(const std::string& path) {
    write_scene(test::with_second_lamp(test::uneven_scene()), path);
    Viewer viewer;
    take(viewer, open_document(path));
    viewer.look.display.exposure_ev = kExposure_ev;
    return viewer;
}

void wait_for_all(Worker& worker) {
    while (worker.progress().whole_left > 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_EQ(worker.progress().error, "");
}

/// The picture of a scene's file as `nearfield render --device gl --png` writes it.
std::string rendered(const std::string& scene, const std::string& camera) {
    render::RenderOptions options;
    options.size_px = kSize;
    options.camera = camera;
    options.shows_lamps = true;
    const Picture picture = render::render_gl(read_scene(scene), options).picture;
    const render::DisplayOptions display{render::ToneMap::Filmic, kExposure_ev};
    write_png(render::display(picture, display).srgb, kSize, "rendered.png");
    return bytes_of("rendered.png");
}

std::size_t lines_with(const std::string& text, const std::string& path) {
    std::ifstream stream(path);
    std::size_t count = 0;
    for (std::string line; std::getline(stream, line);)
        count += line.find(text) != std::string::npos ? 1 : 0;
    return count;
}

TEST(ViewerRecord, TurntablesAreTheirScenesPictures) {
    const Viewer viewer = opened("turned.gltf");
    {
        Worker worker([] {});
        record_turntable(worker, viewer, kSize, "turntable", 3);
        wait_for_all(worker);
    }
    EXPECT_EQ(lines_with("nearfield render 'turntable.gltf' --device gl", "turntable.sh"), 3U);
    const std::string second = bytes_of("turntable_002.png");
    EXPECT_EQ(rendered("turntable.gltf", "turntable 002"), second);
    EXPECT_NE(second, bytes_of("turntable_001.png"));
}

TEST(ViewerRecord, SweepsTurnTheLamp) {
    const Viewer viewer = opened("swept.gltf");
    const int lamp = viewer.history.now.lamps[0].id;
    {
        Worker worker([] {});
        record_sweep(worker, viewer, kSize, "sweep", 3, lamp, 20.0);
        wait_for_all(worker);
        EXPECT_THROW(record_sweep(worker, viewer, kSize, "none", 3, 99, 20.0), Error);
    }
    EXPECT_EQ(lines_with("--camera 'sweep'", "sweep.sh"), 3U);
    const std::string last = bytes_of("sweep_003.png");
    EXPECT_EQ(rendered("sweep_003.gltf", "sweep"), last);
    EXPECT_NE(last, bytes_of("sweep_001.png"));
    const auto ahead = [](const std::string& scene) {
        return glm::normalize(glm::dvec3(read_scene(scene).luminaires[0].world_from_luminaire[2]));
    };
    const glm::dvec3 a = ahead("sweep_001.gltf"), b = ahead("sweep_003.gltf");
    EXPECT_NEAR(a.y, b.y, 1e-9);  // about the vertical
    const double turned_rad = std::atan2(b.x, b.z) - std::atan2(a.x, a.z);
    EXPECT_NEAR(std::remainder(glm::degrees(turned_rad), 360.0), 20.0, 1e-6);
}

// What is asked for in between is shown, and no frame is lost for it.
TEST(ViewerRecord, FramesWaitForWhoeverMovesSomething) {
    const Viewer viewer = opened("between.gltf");
    Worker worker([] {});
    record_turntable(worker, viewer, kSize, "between", 4);
    Request request = request_of(viewer, kSize);
    for (int k = 1; k <= 5; ++k) {
        request.serial = k;
        worker.show(request);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    wait_for_all(worker);
    const auto is_shown = [&] {
        const Progress progress = worker.progress();
        return progress.frame && progress.frame->serial == 5 && progress.is_final;
    };
    while (!is_shown())
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    for (int k = 1; k <= 4; ++k)
        EXPECT_TRUE(fs::exists("between_00" + std::to_string(k) + ".png"));
}

TEST(ViewerRecord, APictureComparedWithItsFileDiffersByNothing) {
    Viewer viewer = opened("compared.gltf");
    Worker worker([] {});
    write_picture_by(worker, viewer, kSize, "reference.exr");
    wait_for_all(worker);
    Request request = request_of(viewer, kSize);
    request.serial = 1;
    worker.show(request);
    while (!refresh(viewer, worker.progress()) || !viewer.progress.is_final)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    compare_with(viewer, "reference.exr");
    ASSERT_TRUE(refresh(viewer, worker.progress()));
    ASSERT_TRUE(viewer.difference);
    EXPECT_EQ(viewer.difference->rms_rel, 0.0);
    change(viewer, SetDim{viewer.history.now.lamps[0].id, 0.5});
    refresh(viewer, worker.progress());
    EXPECT_GT(viewer.difference->rms_rel, 0.01);
    std::ofstream("no_picture.exr") << "nothing";
    EXPECT_THROW(compare_with(viewer, "no_picture.exr"), Error);
}

}  // namespace
}  // namespace nearfield::viewer
