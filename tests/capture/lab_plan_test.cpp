// SPDX-License-Identifier: Apache-2.0
// What a plan says of the lab's parts: board, views, filter, screen, photometer, and the shots that
// follow. Values are read off the text by hand.
#include "formats/capture/plan.h"
#include "formats/files/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace nearfield::capture {
namespace {

constexpr const char* kPlan = R"({
  "nearfield_plan": 1, "stage": "camera",
  "camera": {"pixel_format": "BayerRG12", "rgb_from_raw": [1.5, -0.4, -0.1, 0, 1.25, 0.5, 2, 3, 4]},
  "filter": {"columns": 3, "rows": 2, "pitch_m": [0.02, 0.02], "basis": "bspline", "peak": [0.5, 0.51, 0.49]},
  "filter_views": {"positions": [[0, 0], [2, 1], [1, 0]], "exposure_us": 700},
  "exposures_us": [100, 400, 1600], "darks_per_exposure": 1, "blocked_per_exposure": 2,
  "flats": {"count": 2, "exposures_us": [400, 600, 900]},
  "targets": {"board": {"kind": "charuco", "squares": [8, 6], "square_m": 0.03, "marker_m": 0.0225, "dictionary": "4x4_50"},
              "views": ["screen", "filter", "free", "free"], "exposure_us": 800},
  "screen": {"factor": [[0, 1], [10, 0.997], [30, 0.99]]},
  "photometer": {"on_screen_board_m": [0.11, -0.02], "correction": 0.997, "sigma_rel": 0.003, "mismatch_rel": 0.02}
})";

Plan plan_of(const std::string& text) {
    const Json document = parse_json(text, "plan.json");
    return plan_from({document, "plan.json"});
}

std::string with(const std::string& old_text, const std::string& new_text) {
    std::string text = kPlan;
    const std::size_t at = text.find(old_text);
    EXPECT_NE(at, std::string::npos) << old_text;
    return text.replace(at, old_text.size(), new_text);
}

std::string complaint(const std::string& text) {
    try {
        plan_of(text);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(LabPlan, SaysWhatIsWritten) {
    const Plan plan = plan_of(kPlan);
    ASSERT_TRUE(plan.board.has_value());
    EXPECT_EQ(plan.board->kind, BoardKind::Charuco);
    EXPECT_EQ(plan.board->squares, glm::ivec2(8, 6));
    EXPECT_EQ(plan.board->square_m, 0.03);
    EXPECT_EQ(plan.board->marker_m, 0.0225);
    EXPECT_EQ(plan.board->dictionary, "4x4_50");
    EXPECT_EQ(plan.views, (std::vector{TargetPlane::Screen, TargetPlane::Filter, TargetPlane::Free,
                                       TargetPlane::Free}));
    // Row by row: the first raw color's weights are the first column.
    EXPECT_EQ(plan.camera.rgb_from_raw * glm::dvec3(1, 0, 0), glm::dvec3(1.5, 0, 2));
    EXPECT_EQ(plan.filter_peak, glm::dvec3(0.5, 0.51, 0.49));
    EXPECT_EQ(plan.filter_views.positions,
              (std::vector{glm::ivec2(0, 0), glm::ivec2(2, 1), glm::ivec2(1, 0)}));
    EXPECT_EQ(plan.screen.angle_deg, (std::vector{0.0, 10.0, 30.0}));
    EXPECT_EQ(plan.screen.factor, (std::vector{1.0, 0.997, 0.99}));
    ASSERT_TRUE(plan.photometer.has_value());
    EXPECT_EQ(plan.photometer->on_screen_board_m, glm::dvec2(0.11, -0.02));
    EXPECT_EQ(plan.photometer->correction, 0.997);
    EXPECT_EQ(plan.photometer->sigma_rel, 0.003);
    EXPECT_EQ(plan.photometer->mismatch_rel, 0.02);
}

TEST(LabPlan, SurvivesItsOwnText) {
    const Json once = json_of(plan_of(kPlan));
    EXPECT_EQ(once, json_of(plan_of(once.dump())));
    const Json written = parse_json(kPlan, "plan.json");
    for (const char* key : {"filter", "filter_views", "flats", "targets", "screen", "photometer"})
        EXPECT_EQ(once[key], written[key]) << key;
    EXPECT_EQ(once["camera"]["rgb_from_raw"], written["camera"]["rgb_from_raw"]);
}

TEST(LabPlan, LeavesAsItWasWhatIsNotSaid) {
    const Plan plan = plan_of(R"({"nearfield_plan": 1, "stage": "manual", "exposures_us": [5],
        "filter": {"columns": 1, "rows": 1, "pitch_m": [1, 1], "basis": "box", "peak": 0.25},
        "targets": {"count": 2}, "flats": {"count": 1, "exposure_us": 7}})");
    EXPECT_FALSE(plan.board.has_value());
    EXPECT_FALSE(plan.photometer.has_value());
    EXPECT_EQ(plan.views, (std::vector{TargetPlane::Free, TargetPlane::Free}));
    EXPECT_EQ(plan.flat_exposures_us, std::vector{7.0});
    EXPECT_EQ(plan.filter_peak, glm::dvec3(0.25));
    EXPECT_EQ(plan.camera.rgb_from_raw, glm::dmat3(1.0));
    EXPECT_TRUE(plan.screen.angle_deg.empty());
    EXPECT_TRUE(plan.filter_views.positions.empty());
    EXPECT_EQ(plan.blocked, 0);
}

// 4 targets, 2 flats at 3 exposures, 3 filter views, darks at 100 400 1600 and 800, 600, 900, 700,
// 2 frames of the blocked lamp at 3 exposures.
TEST(LabPlan, TakesFilterViewsBetweenFlatsAndDarks) {
    const std::vector<Shot> shots = shots_of(plan_of(kPlan));
    const auto kind_at = [&](std::size_t k) { return shots.at(k).kind; };
    EXPECT_EQ(kind_at(3), ShotKind::Target);
    EXPECT_EQ(kind_at(4), ShotKind::Flat);
    EXPECT_EQ(kind_at(9), ShotKind::Flat);
    EXPECT_EQ(kind_at(10), ShotKind::Filter);
    EXPECT_EQ(kind_at(12), ShotKind::Filter);
    EXPECT_EQ(kind_at(13), ShotKind::Dark);
    EXPECT_EQ(kind_at(19), ShotKind::Dark);
    EXPECT_EQ(kind_at(20), ShotKind::Blocked);
    EXPECT_EQ(kind_at(25), ShotKind::Blocked);
    EXPECT_EQ(name_of(shots[25]), "blocked_1600us_r001");
    EXPECT_EQ(kind_at(26), ShotKind::Light);
    EXPECT_EQ(shots.size(), 26U + 6U * 3U);
    EXPECT_EQ(name_of(shots[11]), "filter_x002_y001_700us_r000");
    EXPECT_EQ(shots[5].repeat, 1);
    EXPECT_EQ(shots[6].exposure_us, 600);
    std::vector<double> darks_us;
    for (std::size_t k = 13; k < 20; ++k)
        darks_us.push_back(shots[k].exposure_us);
    std::sort(darks_us.begin(), darks_us.end());
    EXPECT_EQ(darks_us, (std::vector{100.0, 400.0, 600.0, 700.0, 800.0, 900.0, 1600.0}));
    const Json word = word_of(ShotKind::Filter);
    EXPECT_EQ(shot_kind_from({word, "kind"}), ShotKind::Filter);
    const Json blocked = word_of(ShotKind::Blocked);
    EXPECT_EQ(shot_kind_from({blocked, "kind"}), ShotKind::Blocked);
}

TEST(LabPlan, WithoutAFilterTakesTargetsAlone) {
    constexpr const char* kTargets =
        R"({"nearfield_plan": 1, "stage": "manual", "darks_per_exposure": 1,
        "targets": {"board": {"kind": "chessboard", "squares": [10, 7], "square_m": 0.025},
                    "views": ["free", "free"], "exposure_us": 4000}})";
    const Plan plan = plan_of(kTargets);
    EXPECT_FALSE(plan.bracket.is_auto);
    const std::vector<Shot> shots = shots_of(plan);
    ASSERT_EQ(shots.size(), 3U);
    EXPECT_EQ(shots[1].kind, ShotKind::Target);
    EXPECT_EQ(shots[2].kind, ShotKind::Dark);
    EXPECT_EQ(shots[2].exposure_us, 4000);
    EXPECT_EQ(json_of(plan), json_of(plan_of(json_of(plan).dump())));
}

TEST(LabPlan, AsksForExposuresWhereNoBracketHasThem) {
    const auto complaint_of_file = [](const std::string& text) -> std::string {
        const std::string path = "lab_plan.json";
        std::ofstream(path) << text;
        try {
            read_plan(path);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    const std::string start = R"({"nearfield_plan": 1, "stage": "manual")";
    EXPECT_THAT(complaint_of_file(start + R"(, "targets": {"count": 2}})"),
                testing::HasSubstr("lab_plan.json.targets"));
    EXPECT_THAT(complaint_of_file(start + R"(, "flats": {"count": 2}})"),
                testing::HasSubstr("lab_plan.json.flats"));
    EXPECT_THAT(complaint_of_file(start + "}"), testing::HasSubstr("nothing to take"));
    EXPECT_EQ(complaint_of_file(start + R"(, "targets": {"count": 2, "exposure_us": 5}})"),
              "accepted");
    std::filesystem::remove("lab_plan.json");
}

TEST(LabPlan, RefusesSlipsOfThePen) {
    struct Slip {
        const char* right;
        const char* wrong;
        const char* named;
    };
    constexpr const char* kBoard = "targets.board";
    const std::vector<Slip> slips = {
        {"\"charuco\"", "\"chess\"", "one of charuco, chessboard"},
        {"\"charuco\"", "\"chessboard\"", "'marker_m'"},
        {"[8, 6]", "[8, 2]", "targets.board.squares[1]"},
        {"[8, 6]", "[8]", kBoard},
        {"0.0225", "0.031", "targets.board.marker_m"},
        {"0.03,", "30,", "targets.board.square_m"},
        {"4x4_50", "DICT_4X4_50", "targets.board.dictionary"},
        {"\"filter\", \"free\"", "\"floor\", \"free\"", "targets.views[1]"},
        {"\"views\":", "\"count\": 4, \"views\":", "both"},
        {"0, 1.25", "0, 1e9", "camera.rgb_from_raw[4]"},
        {", 2, 3, 4]", "]", "camera.rgb_from_raw"},
        {"[0.5, 0.51, 0.49]", "[0.5, 1.51, 0.49]", "filter.peak[1]"},
        {"[0.5, 0.51, 0.49]", "0", "filter.peak"},
        {"[2, 1]", "[3, 1]", "filter_views.positions[1][0]"},
        {"[2, 1]", "[0, 0]", "at most once"},
        {"[400, 600, 900]", "[400, 600, 500]", "flats.exposures_us[2]"},
        {"\"exposures_us\": [400", "\"exposure_us\": 3, \"exposures_us\": [400", "both"},
        {"[0, 1], [10", "[0, 0.9], [10", "screen.factor[0]"},
        {"[0, 1], [10", "[5, 1], [10", "screen.factor[0]"},
        {"[10, 0.997]", "[40, 0.997]", "screen.factor[2][0]"},
        {"[10, 0.997]", "[10]", "screen.factor[1]"},
        {"\"screen\", \"filter\"", "\"free\", \"filter\"", "no view on the screen"},
        {"\"sigma_rel\": 0.003, ", "", "photometer"},
        {"0.02}", "2}", "photometer.mismatch_rel"},
        {"0.997, \"sigma", "0, \"sigma", "photometer.correction"},
        {"exposure\": 2,", "exposure\": -2,", "blocked_per_exposure"},
        {"[0.11, -0.02]", "[110, -20]", "photometer.on_screen_board_m[0]"},
    };
    for (const Slip& slip : slips)
        EXPECT_THAT(complaint(with(slip.right, slip.wrong)), testing::HasSubstr(slip.named));
}

TEST(Board, IsSaidInShortAsInFull) {
    const BoardPlan charuco = board_from_text("charuco:8x6:0.03:0.0225:4x4_50", "--board");
    EXPECT_EQ(json_of(charuco), json_of(*plan_of(kPlan).board));
    const BoardPlan chessboard = board_from_text("chessboard:10x7:0.025", "--board");
    EXPECT_EQ(chessboard.kind, BoardKind::Chessboard);
    EXPECT_EQ(chessboard.squares, glm::ivec2(10, 7));
    EXPECT_EQ(chessboard.square_m, 0.025);
    for (const char* wrong :
         {"", "chessboard", "chessboard:10x7", "chessboard:10:0.025", "chessboard:10x7:0.025m",
          "chessboard:10x7:0.025:0.01:4x4_50", "charuco:8x6:0.03", "charuco:8x6:0.03:0.0225:5x5",
          "charuco:8x6:0.03:0.04:4x4_50", "chessboard:4e1x7:0.025", "chessboard:2x7:0.025"})
        EXPECT_THROW(board_from_text(wrong, "--board"), Error) << wrong;
}

}  // namespace
}  // namespace nearfield::capture
