// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/plan.h"

#include "formats/files/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace nearfield::capture {
namespace {

constexpr const char* kPlan = R"({
  "nearfield_plan": 1, "stage": "camera",
  "camera": {"device": "127.0.0.1", "pixel_format": "Mono12", "region_px": [8, 4, 64, 48]},
  "filter": {"columns": 3, "rows": 2, "pitch_m": [0.016, 0.016], "basis": "bspline"},
  "exposures_us": [100, 400, 1600], "repeats": 2, "darks_per_exposure": 2,
  "flats": {"count": 1, "exposure_us": 500}, "targets": {"count": 2},
  "drift": {"every": 4, "limit_rel": 0.02}
})";

Plan plan_of(const std::string& text) {
    const Json document = parse_json(text, "plan.json");
    return plan_from({document, "plan.json"});
}

std::string with(const std::string& old_text, const std::string& new_text) {
    std::string text = kPlan;
    text.replace(text.find(old_text), old_text.size(), new_text);
    return text;
}

TEST(Plan, SurvivesItsOwnText) {
    const Json once = json_of(plan_of(kPlan));
    EXPECT_EQ(once, json_of(plan_of(once.dump())));
    EXPECT_EQ(once["camera"]["region_px"], (Json{8, 4, 64, 48}));
    EXPECT_EQ(once["exposures_us"], (Json{100.0, 400.0, 1600.0}));
}

// 2 targets, 1 flat, 2 darks at 4 exposures (the flat's is one of its own), 2 looks at the
// reference, 6 positions x 3 x 2.
TEST(Plan, CountsItsShots) {
    const std::vector<Shot> shots = shots_of(plan_of(kPlan));
    EXPECT_EQ(shots.size(), 2U + 1U + 8U + 2U + 36U);
    for (std::size_t k = 0; k < shots.size(); ++k)
        EXPECT_EQ(shots[k].number, static_cast<int>(k));
    std::set<std::string> names;
    for (const Shot& shot : shots)
        names.insert(name_of(shot));
    EXPECT_EQ(names.size(), shots.size());
}

TEST(Plan, MovesTheFilterByOneStepAtATime) {
    glm::ivec2 position{-1};
    int positions = 0;
    for (const Shot& shot : shots_of(plan_of(kPlan))) {
        if (shot.kind != ShotKind::Light || shot.position == position)
            continue;
        if (position.x >= 0) {
            EXPECT_EQ(
                std::abs(shot.position.x - position.x) + std::abs(shot.position.y - position.y), 1);
        }
        position = shot.position;
        ++positions;
    }
    EXPECT_EQ(positions, 6);
}

TEST(Plan, EstimatesExposuresMovesAndOverhead) {
    Plan plan = plan_of(with("\"drift\"", "\"settle_s\": 0.5, \"drift\""));
    plan.drift_every = 0;
    plan.views.clear();
    plan.flats = 0;
    plan.darks = 0;
    const double exposures_s = 6 * 2 * (100 + 400 + 1600) * 1e-6;
    EXPECT_NEAR(estimate_time_s(plan, shots_of(plan), 0.01), exposures_s + 36 * 0.01 + 6 * 0.5,
                1e-12);
}

TEST(Plan, RefusesWhatItCannotMean) {
    const auto complaint = [](const std::string& text) -> std::string {
        try {
            plan_of(text);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_THAT(complaint(with("[100, 400, 1600]", "[100, 50]")),
                testing::HasSubstr("plan.json.exposures_us[1]"));
    EXPECT_THAT(complaint(with("[100, 400, 1600]", "[]")),
                testing::HasSubstr("at least one exposure"));
    EXPECT_THAT(complaint(with("\"columns\": 3", "\"columns\": 0")),
                testing::HasSubstr("filter.columns"));
    EXPECT_THAT(complaint(with("\"camera\",", "\"robot\",")),
                testing::HasSubstr("one of manual, camera"));
    EXPECT_THAT(complaint(with("nearfield_plan\": 1", "nearfield_plan\": 3")),
                testing::HasSubstr("version 1"));
    EXPECT_THAT(complaint(with("\"repeats\"", "\"repeat\"")), testing::HasSubstr("'repeat'"));
    EXPECT_THAT(complaint(with("0.016, 0.016", "16, 16")), testing::HasSubstr("filter.pitch_m[0]"));
    EXPECT_THAT(complaint(with("64, 48", "64")), testing::HasSubstr("region_px"));
}

// Every brightness from the brightest to the darkest of interest, in fine steps: counted one by
// one.
TEST(Bracket, ExposesEveryBrightnessWellTwice) {
    constexpr double kLow = 0.05, kHigh = 0.8;
    for (const double darkest_share : {1.0, 0.3, 1e-2, 1e-3, 1e-5}) {
        BracketPlan plan;
        plan.darkest_share = darkest_share;
        plan.least_us = 1e-3;
        plan.most_us = 1e12;
        constexpr double kBrightest_per_us = 3e-3;
        const std::vector<double> exposures_us = bracket_of(plan, kBrightest_per_us, kLow, kHigh);
        for (int k = 0; k <= 4000; ++k) {
            const double light = kBrightest_per_us * std::pow(darkest_share, k / 4000.0);
            int well = 0;
            for (const double exposure_us : exposures_us)
                well += light * exposure_us >= kLow * (1 - 1e-12) &&
                                light * exposure_us <= kHigh * (1 + 1e-12)
                            ? 1
                            : 0;
            ASSERT_GE(well, 2) << darkest_share << " " << k;
        }
        // No more than are needed: one fewer would leave a gap.
        const double span = std::log(exposures_us.back() / exposures_us.front());
        EXPECT_LE(static_cast<double>(exposures_us.size()) - 1,
                  std::ceil(span / std::log(4.0) - 1e-9) + 1e-9);
    }
}

TEST(Bracket, SaysWhatDoesNotFit) {
    BracketPlan plan;
    plan.least_us = 1000;
    EXPECT_THROW(bracket_of(plan, 1e-2, 0.05, 0.8), Error);
    plan.least_us = 1;
    plan.most_us = 100;
    EXPECT_THROW(bracket_of(plan, 1e-3, 0.05, 0.8), Error);
}

}  // namespace
}  // namespace nearfield::capture
