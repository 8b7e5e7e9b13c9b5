// SPDX-License-Identifier: Apache-2.0
#include "acquire/stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace nearfield::acquire {
namespace {

using capture::Shot;
using capture::ShotKind;
using capture::TargetPlane;
using testing::HasSubstr;

TEST(ManualStage, AsksForWhatEachShotNeedsOnce) {
    std::vector<std::string> asked;
    const auto stage = manual_stage(
        [&asked](const std::string& request, const ShouldStop&) { asked.push_back(request); },
        {TargetPlane::Screen, TargetPlane::Filter, TargetPlane::Free});
    const auto arrange = [&stage](const Shot& shot) { stage->arrange(shot, [] { return false; }); };
    for (int view = 0; view < 3; ++view)
        arrange({view, ShotKind::Target, {-1, -1}, view, 100, 0});
    arrange({3, ShotKind::Flat, {-1, -1}, -1, 100, 0});
    arrange({4, ShotKind::Flat, {-1, -1}, -1, 200, 1});
    arrange({5, ShotKind::Filter, {2, 1}, -1, 100, 0});
    arrange({6, ShotKind::Filter, {0, 1}, -1, 100, 0});
    arrange({7, ShotKind::Dark, {-1, -1}, -1, 100, 0});
    arrange({8, ShotKind::Blocked, {-1, -1}, -1, 100, 0});
    arrange({9, ShotKind::Light, {2, 1}, -1, 100, 0});
    arrange({10, ShotKind::Light, {2, 1}, -1, 400, 0});
    ASSERT_EQ(asked.size(), 9U);
    EXPECT_THAT(asked[0], AllOf(HasSubstr("on the screen"), HasSubstr("view 1")));
    EXPECT_THAT(asked[1],
                AllOf(HasSubstr("screen away"), HasSubstr("filter's plane"), HasSubstr("view 2")));
    EXPECT_THAT(asked[2], AllOf(HasSubstr("hold the target"), HasSubstr("view 3")));
    EXPECT_THAT(asked[3], HasSubstr("evenly bright"));
    EXPECT_THAT(asked[4], AllOf(HasSubstr("screen away"), HasSubstr("behind the filter"),
                                HasSubstr("column 2, row 1")));
    EXPECT_THAT(asked[5], HasSubstr("column 0, row 1"));
    EXPECT_THAT(asked[6], AllOf(HasSubstr("screen in its place"), HasSubstr("darken the lamp")));
    EXPECT_THAT(asked[7], AllOf(HasSubstr("lamp on"), HasSubstr("opaque plate")));
    EXPECT_THAT(asked[8], AllOf(HasSubstr("lamp on"), HasSubstr("column 2, row 1")));
}

}  // namespace
}  // namespace nearfield::acquire
