// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "sample_data/bench/bench_json.h"
#include "tests/sample_data/bench_small.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace nearfield::sample_data {
namespace {

const std::string kFolder = std::string(NEARFIELD_SOURCE_DIR) + "/sample_data/";

std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(BenchFile, SampleBenchesAreReadAndWrittenUnchanged) {
    for (const std::string name : {"bench_near.json", "bench_far.json"}) {
        const Bench bench = read_bench(kFolder + name);
        EXPECT_EQ(bench.filter.grid, glm::ivec2(11, 9)) << name;
        EXPECT_EQ(bench.targets.views.size(), 30U) << name;
        write_bench(bench, "again.json");
        EXPECT_EQ(to_json(read_bench("again.json")), to_json(bench)) << name;
    }
}

TEST(BenchFile, EveryFieldSurvives) {
    Bench bench = test::small_bench();
    bench.seed = 0xFFFFFFFFFFFFFFFFULL;
    bench.setup = Setup::Pinhole;
    bench.camera.mosaic = Mosaic::Rggb;
    bench.camera.response_e_per_cd_m2_s = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    bench.filter.profile = {"measured", {{0.5, 0.25, -0.125}, {0.5, -0.25, 0.0}}};
    bench.targets.views.resize(2);
    bench.targets.views[1].plane = BoardPlane::Filter;
    write_bench(bench, "every.json");
    const Bench again = read_bench("every.json");
    EXPECT_EQ(to_json(again), to_json(bench));
    EXPECT_EQ(again.seed, bench.seed);
    EXPECT_EQ(again.camera.response_e_per_cd_m2_s, bench.camera.response_e_per_cd_m2_s);
    EXPECT_EQ(again.camera.bench_from_camera.rotation, bench.camera.bench_from_camera.rotation);
    EXPECT_EQ(again.filter.profile.cells, bench.filter.profile.cells);
}

struct Slip {
    const char* pointer;  // JSON pointer of what is changed
    Json value;
    const char* where;  // what the message names
};

TEST(BenchFile, SlipsAreNamed) {
    const Json good = to_json(test::small_bench());
    const std::vector<Slip> slips = {
        {"/delta_m", -1, "delta_m"},
        {"/delta_m", "wide", "delta_m"},
        {"/detla_m", 1, "detla_m"},
        {"/seed", -3, "seed"},
        {"/setup", "mirror", "setup"},
        {"/filter/grid", {0, 3}, "filter.grid"},
        {"/filter/grid", {3}, "filter.grid"},
        {"/filter/profile", "gauss", "filter.profile"},
        {"/filter/profile", {{"cells", Json::array()}}, "filter.profile"},
        {"/filter/pitch_m", {0.0, 0.02}, "filter.pitch_m"},
        {"/camera/bits", 17, "camera.bits"},
        {"/camera/bits", 12.5, "camera.bits"},
        {"/camera/fx_px", 0, "camera.fx_px"},
        {"/camera/bench_from_camera/rotation", {1, 0, 0, 0, 1, 0, 0, 0, 1.1}, "rotation"},
        {"/camera/bench_from_camera/rotation", {-1, 0, 0, 0, 1, 0, 0, 0, 1}, "rotation"},
        {"/camera/hot_pixels", 3, "hot_pixels"},
        {"/targets/board/squares", {20, 20}, "squares"},
        {"/targets/views", {{{"plane", "floor"}}}, "targets.views[0].plane"},
        {"/photometer/normal", {0, 0, -2}, "photometer.normal"},
        {"/camera", 5, "camera"},
    };
    for (const Slip& slip : slips) {
        Json bad = good;
        bad[Json::json_pointer(slip.pointer)] = slip.value;
        write_file(bad.dump(), "slip.json");
        try {
            read_bench("slip.json");
            ADD_FAILURE() << slip.pointer << " is accepted";
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_NE(message.find("slip.json"), std::string::npos) << message;
            EXPECT_NE(message.find(slip.where), std::string::npos) << message;
        }
    }
    EXPECT_THROW(read_bench("no_such.json"), Error);
}

TEST(BenchFile, BrokenFilesGiveErrors) {
    const std::string good = text_of(kFolder + "bench_near.json");
    std::uint64_t refused = 0;
    const std::uint64_t count = test::fuzz_count();
    for (std::uint64_t k = 0; k < count; ++k) {
        const std::string bytes = test::mutate(good, k);
        try {
            check(bench_from_json(parse_json(bytes, "mutated"), "mutated"), "mutated");
        } catch (const Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, count / 2);
}

TEST(BenchFile, TruthHoldsWhatWasDrawn) {
    Bench bench = test::small_bench();
    bench.camera.size_px = {8, 8};
    bench.filter.step_sigma_m = 1e-4;
    bench.filter.stage_scale = glm::dvec2(1.0);
    bench.filter.stage_skew_deg = 0.0;
    bench.filter.grid = {40, 40};
    bench.setup = Setup::Direct;
    write_truth(*prepare(bench), "truth.json");
    const Json truth = parse_json(text_of("truth.json"), "truth.json");
    ASSERT_EQ(truth["position_m"].size(), 1600U);
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < 1600; ++k) {
        const double nominal = 0.004 + (k % 40 - 19.5) * 0.03;
        const double error =
            truth["position_m"][static_cast<std::size_t>(k)][0].get<double>() - nominal;
        sum += error / 1600;
        square += error * error / 1600;
    }
    EXPECT_NEAR(sum, 0.0, 4.0 * 1e-4 / 40);
    EXPECT_NEAR(std::sqrt(square), 1e-4, 1e-4 * 4.0 / std::sqrt(2.0 * 1600));
    EXPECT_TRUE(truth.contains("optics_error_rel"));
}

TEST(BenchFile, LampBehindTheScreenIsRefused) {
    Bench bench = test::small_bench();
    bench.lamp.u_from_lamp.translation_m.z = 1.0;
    EXPECT_THROW(prepare(bench), Error);
    bench = test::small_bench();
    bench.camera.bench_from_camera.translation_m.z = 500.0;
    bench.camera.bench_from_camera.translation_m.x = 500.0;
    EXPECT_THROW(prepare(bench), Error);
}

}  // namespace
}  // namespace nearfield::sample_data
