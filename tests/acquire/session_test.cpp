// SPDX-License-Identifier: Apache-2.0
#include "acquire/session.h"

#include "formats/files/error.h"
#include "tests/acquire/scripted_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace nearfield::acquire {
namespace {

using capture::Capture;
using capture::CaptureWriter;

class Session : public testing::Test {
  protected:
    void SetUp() override { std::filesystem::remove_all(folder_); }

    static capture::CaptureHeader header() {
        capture::CaptureHeader header;
        header.plan.emplace();
        header.plan->grid = {3, 2};
        header.plan->pitch_m = {0.016, 0.016};
        header.plan->basis = "bspline";
        header.plan->darks = 2;
        header.plan->bracket.exposures_us = {300, 900, 2700};
        header.plan->drift_every = 2;
        return header;
    }

    // A session on the folder, new or gone on with.
    SessionResult run(Script& script, double reconnect_s = 10) {
        CaptureWriter writer = capture::holds_capture(folder_)
                                   ? CaptureWriter::reopen(folder_)
                                   : CaptureWriter::create(folder_, header());
        SessionOptions options;
        options.open = [&script] { return open_scripted(script); };
        options.should_stop = [&script] {
            return script.stop_at > 0 && script.frames >= script.stop_at;
        };
        options.reconnect_s = reconnect_s;
        return run_session(writer, capture::read_capture(folder_), options);
    }

    std::string complaint(Script& script) {
        try {
            run(script);
        } catch (const Error& error) {
            return error.what();
        }
        return "no complaint";
    }

    void expect_complete() const {
        const Capture capture = capture::read_capture(folder_);
        EXPECT_TRUE(missing_shots(capture).empty());
        EXPECT_TRUE(damaged_frames(folder_, capture, {}).empty());
    }

    const std::string folder_ = "session_capture";
    const int shots_ = 2 * 3 + 6 * 3 + 3;
};

TEST_F(Session, TakesEveryShotOnce) {
    Script script;
    const SessionResult result = run(script);
    EXPECT_EQ(result.frames, shots_);
    EXPECT_EQ(result.retaken, 0);
    EXPECT_EQ(result.discarded_frames, 0);
    EXPECT_GT(result.ratios, 0);
    EXPECT_LT(result.worst_ratio_rel, 0.01);
    EXPECT_LT(result.worst_drift_rel, 1e-3);  // noise alone
    expect_complete();
    EXPECT_EQ(run(script).frames, 0);
}

// The bench shows an even 500 DN and black where it stands for a look at the filter.
TEST_F(Session, LooksAtTheFilterBeforeItsDarks) {
    capture::CaptureHeader with_views = header();
    with_views.plan->views = {capture::TargetPlane::Screen, capture::TargetPlane::Free};
    with_views.plan->flats = 2;
    with_views.plan->flat_exposures_us = {150, 300};
    with_views.plan->filter_views = {{{0, 0}, {2, 1}}, 500};
    CaptureWriter::create(folder_, with_views);
    Script stopped;
    stopped.stop_at = 18;  // 11 frames to find the latency, then within the looks at the filter
    EXPECT_THROW(run(stopped), Stopped);
    EXPECT_EQ(capture::read_capture(folder_).frames.size(), 7U);
    Script script;
    const SessionResult result = run(script);
    EXPECT_LT(result.worst_ratio_rel, 0.01);
    expect_complete();
    std::vector<glm::ivec2> seen;
    for (const auto& [number, record] : capture::read_capture(folder_).frames) {
        if (record.shot.kind != capture::ShotKind::Filter)
            continue;
        seen.push_back(record.shot.position);
        EXPECT_NEAR(record.mean_dn, 64 + 500 + 1.5, 0.5);
        EXPECT_EQ(record.exposure_us, 500);
    }
    EXPECT_EQ(seen, (std::vector{glm::ivec2(0, 0), glm::ivec2(2, 1)}));
    const Capture capture = capture::read_capture(folder_);
    EXPECT_EQ(capture.frames.at(6).shot.kind, capture::ShotKind::Filter);
    EXPECT_EQ(capture.frames.at(8).shot.kind, capture::ShotKind::Dark);
}

// What photographs of a board become, taken by a camera: no position, nothing metered or judged.
TEST_F(Session, TakesTargetsAlone) {
    capture::CaptureHeader targets;
    targets.plan.emplace();
    targets.plan->views = {capture::TargetPlane::Free, capture::TargetPlane::Free};
    targets.plan->target_exposure_us = 400;
    targets.plan->darks = 1;
    CaptureWriter::create(folder_, targets);
    Script script;
    const SessionResult result = run(script);
    EXPECT_EQ(result.frames, 3);
    EXPECT_EQ(result.share_exposed_twice, 1);
    expect_complete();
}

TEST_F(Session, WaitsForALateCamera) {
    Script script;
    script.late_frames = 2;
    EXPECT_EQ(run(script).discarded_frames, 2);
    expect_complete();
    // The right exposure in every frame: its mean follows.
    const Capture capture = capture::read_capture(folder_);
    std::map<double, double> least;
    for (const auto& [number, record] : capture.frames)
        if (record.shot.position == glm::ivec2(0, 0) &&
            record.shot.kind == capture::ShotKind::Light)
            least[record.shot.exposure_us] = record.mean_dn;
    EXPECT_LT(least[300] * 1.5, least[900]);
}

TEST_F(Session, NamesACameraThatIgnoresExposure) {
    Script script;
    script.ignores_exposure = true;
    EXPECT_THAT(complaint(script), testing::HasSubstr("ignores exposure"));
}

TEST_F(Session, NamesAClampedExposure) {
    Script script;
    script.clamps_at_us = 1000;
    EXPECT_THAT(complaint(script), testing::HasSubstr("exposure, us"));
}

TEST_F(Session, NamesExposuresInAnotherRatioAndTakesThePositionAgain) {
    Script script;
    script.true_ratio = 1.1;
    EXPECT_THAT(complaint(script), testing::HasSubstr("true exposures are not those asked for"));
    const Capture capture = capture::read_capture(folder_);
    ASSERT_EQ(capture.rejects.size(), 1U);
    EXPECT_EQ(capture.rejects.front().shots.size(), 3U);
    script.true_ratio = 1;
    run(script);
    expect_complete();
}

TEST_F(Session, StopsWhereTheLampDriftsAndTakesWhatIsDoubtfulAgain) {
    Script script;
    script.drift_per_frame = 2e-3;
    script.drifts_from = 25;
    EXPECT_THAT(complaint(script), testing::HasSubstr("the lamp drifts"));
    EXPECT_GE(capture::read_capture(folder_).rejects.front().shots.size(),
              7U);  // two positions and the look itself
    script.drift_per_frame = 0;
    run(script);
    expect_complete();
}

TEST_F(Session, TakesIncompleteAndStaleFramesAgain) {
    Script script;
    script.incomplete_at = 30;
    script.stale_at = 33;
    EXPECT_EQ(run(script).retaken, 2);
    expect_complete();
    EXPECT_EQ(capture::read_capture(folder_).events.size(), 2U);
}

// A step that finds the latency: 5 frames before the change, 5 after it.
TEST_F(Session, TornFramesDoNotHideALateCamera) {
    for (const int torn_at : {3, 6, 7, 8}) {
        std::filesystem::remove_all(folder_);
        Script script;
        script.late_frames = 2;
        script.incomplete_at = torn_at;
        EXPECT_EQ(run(script).discarded_frames, 2) << torn_at;
        expect_complete();
    }
}

TEST_F(Session, TornFramesWhileACameraIsLateAreDroppedToo) {
    Script script;
    script.late_frames = 2;
    script.incomplete_at = 11;  // the first after the change to the first shot's exposure
    run(script);
    expect_complete();
}

TEST_F(Session, GivesUpWhereNoFrameIsWhole) {
    Script script;
    script.incomplete_at = 30;
    script.incomplete_frames = 7;
    EXPECT_EQ(run(script).retaken, 7);
    std::filesystem::remove_all(folder_);
    script.frames = 0;
    script.incomplete_frames = 8;
    EXPECT_THAT(complaint(script), testing::HasSubstr("no whole new frame"));
}

TEST_F(Session, GoesOnWhenACameraIsLostBeforeTheFirstFrame) {
    Script script;
    script.lost_at = 4;
    EXPECT_EQ(run(script).reconnects, 1);
    expect_complete();
}

TEST_F(Session, GoesOnWhenACameraComesBack) {
    Script script;
    script.lost_at = 25;
    script.tries_to_come_back = 1;
    const SessionResult result = run(script);
    EXPECT_EQ(result.reconnects, 1);
    EXPECT_EQ(result.frames, shots_);
    expect_complete();
}

TEST_F(Session, SaysWhenACameraStaysAway) {
    Script script;
    script.lost_at = 25;
    script.tries_to_come_back = 1000;
    CaptureWriter::create(folder_, header());
    EXPECT_THROW(run(script, 0.5), Error);
    Script well;
    run(well);
    expect_complete();
}

TEST_F(Session, StopsAtAnyFrameAndGoesOn) {
    for (int stop_at = 1; stop_at < 40; stop_at += 3) {
        std::filesystem::remove_all(folder_);
        Script script;
        script.stop_at = stop_at;
        EXPECT_THROW(run(script), Stopped) << stop_at;
        EXPECT_TRUE(damaged_frames(folder_, capture::read_capture(folder_), {}).empty());
        Script well;
        run(well);
        expect_complete();
    }
}

TEST_F(Session, LosesNothingWhenTheStageStalls) {
    Script script;
    script.stalled_at = 30;
    EXPECT_THAT(complaint(script), testing::HasSubstr("stalled"));
    EXPECT_GT(capture::read_capture(folder_).frames.size(), 10U);
    script.stalled_at = 0;
    run(script);
    expect_complete();
}

TEST(Meter, FindsABracketThatShowsAllWell) {
    Script script;
    script.late_frames = 1;
    Bench bench = open_scripted(script);
    capture::Plan plan;
    plan.grid = {3, 2};
    plan.bracket.darkest_share = 1e-2;
    const std::vector<double> exposures_us = meter(bench, plan, [] { return false; });
    // The brightest pixel gives 3 DN in a us at column 0, row 0 of 4031 above black.
    const std::vector<double> expected = capture::bracket_of(plan.bracket, 3.0 / 4031, 0.05, 0.8);
    ASSERT_EQ(exposures_us.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_NEAR(exposures_us[k] / expected[k], 1, 0.05);
}

}  // namespace
}  // namespace nearfield::acquire
