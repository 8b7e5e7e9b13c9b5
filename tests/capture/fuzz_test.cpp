// SPDX-License-Identifier: Apache-2.0
// Proves that no damaged plan, log or frame crashes its reader or raises anything but Error.
#include "formats/capture/capture.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

namespace nearfield::capture {
namespace {

using test::fuzz_count;
using test::mutate;

// Most mutations must be noticed and some must be harmless, else the test would try nothing.
void fuzz(const std::string& valid, const std::function<void(const std::string&)>& read) {
    std::uint64_t taken = 0, refused = 0;
    for (std::uint64_t seed = 0; seed < fuzz_count(); ++seed) {
        try {
            read(mutate(valid, seed));
            ++taken;
        } catch (const Error&) {
            ++refused;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "seed " << seed << " raised " << error.what();
        }
    }
    EXPECT_GT(refused, fuzz_count() / 10);
    EXPECT_GT(taken, 0U);
}

CaptureHeader small_header() {
    CaptureHeader header;
    header.plan.emplace();
    header.plan->grid = {2, 2};
    header.plan->pitch_m = {0.016, 0.016};
    header.plan->basis = "bspline";
    header.plan->bracket.exposures_us = {100, 400};
    return header;
}

TEST(CaptureFuzz, PlansAreReadOrRefused) {
    Plan plan = *small_header().plan;
    plan.board = board_from_text("charuco:8x6:0.03:0.0225:4x4_50", "board");
    plan.views = {TargetPlane::Screen, TargetPlane::Free};
    plan.filter_views.positions = {{0, 1}, {1, 1}};
    plan.flats = 2;
    plan.flat_exposures_us = {100, 300};
    plan.screen = {{0, 10, 20}, {1, 0.99, 0.98}};
    plan.photometer.emplace();
    fuzz(json_of(plan).dump(2), [](const std::string& text) {
        const Json document = parse_json(text, "plan.json");
        const Plan damaged = plan_from({document, "plan.json"});
        if (!damaged.bracket.exposures_us.empty())  // else they are still to be metered
            shots_of(damaged);
    });
}

TEST(CaptureFuzz, FramesAreReadOrRefused) {
    Frame frame;
    frame.size_px = {24, 16};
    frame.bits = 12;
    for (unsigned k = 0; k < 24 * 16; ++k)
        frame.values.push_back(static_cast<std::uint16_t>(k * 997U & 4095U));
    fuzz(encode_frame(frame), [](const std::string& png) { decode_frame(png, 12, "x.png"); });
}

TEST(CaptureFuzz, LogsAreReadOrRefused) {
    const std::string folder = "fuzzed_capture";
    std::filesystem::remove_all(folder);
    {
        CaptureWriter writer = CaptureWriter::create(folder, small_header());
        writer.add(SessionRecord{});
        Frame frame;
        frame.size_px = {4, 4};
        frame.values.assign(16, 5);
        for (const Shot& shot : shots_of(*small_header().plan)) {
            FrameRecord record;
            record.shot = shot;
            writer.add(frame, record);
        }
        writer.add(EventRecord{});
        writer.add(RejectRecord{{1, 2}, "why"});
    }
    const std::string log = folder + "/log.jsonl";
    fuzz(read_file(log), [&](const std::string& text) {
        std::filesystem::remove(log);
        std::ofstream(log, std::ios::binary) << text;
        missing_shots(read_capture(folder));
    });
}

}  // namespace
}  // namespace nearfield::capture
