// SPDX-License-Identifier: Apache-2.0
// Proves that every hard case stays within its limit, and that docs/hard_cases.md says so with the
// numbers that are measured here. It does not prove that no further case exists.
#include "tests/model/hard_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace nearfield::test {
namespace {

class HardCases : public ::testing::TestWithParam<HardCase> {};

void expect_within(const HardRow& row) {
    ASSERT_TRUE(row.in_float || row.in_double) << row.quantity;
    for (const std::optional<double>& measured : {row.in_float, row.in_double})
        if (measured) {
            EXPECT_LE(*measured, row.required) << row.quantity;
        }
    // A pitfall whose number is no worse than what is required would be none.
    if (row.naive) {
        EXPECT_GT(*row.naive, row.required) << row.quantity;
    }
}

TEST_P(HardCases, AreWithinTheirLimits) {
    const std::vector<HardRow> rows = GetParam().measure();
    ASSERT_FALSE(rows.empty());
    for (const HardRow& row : rows)
        expect_within(row);
}

INSTANTIATE_TEST_SUITE_P(All,
                         HardCases,
                         ::testing::ValuesIn(all_hard_cases()),
                         [](const auto& test) { return test.param.name; });

// Rounding differs between vector widths and compilers; what it makes worst varies by about two.
constexpr double kSameNumber = 4.0;

// Whether a cell of the committed page may stand for what was measured.
bool is_same_number(const std::string& committed, const std::string& measured) {
    if (committed == measured)
        return true;
    const double a = std::atof(committed.c_str()), b = std::atof(measured.c_str());
    return a > 0.0 && b > 0.0 && std::max(a / b, b / a) <= kSameNumber;
}

TEST(HardCasesPage, HoldsTheMeasuredNumbers) {
    std::vector<std::vector<HardRow>> measured;
    for (const HardCase& one : all_hard_cases())
        measured.push_back(one.measure());
    const std::string page = hard_cases_page(measured);
    std::ofstream("hard_cases.md") << page;

    std::ostringstream committed;
    committed << std::ifstream(NEARFIELD_SOURCE_DIR "/docs/hard_cases.md").rdbuf();
    const auto expected = table_of(page), got = table_of(committed.str());
    ASSERT_EQ(got.size(), expected.size()) << "rows";
    constexpr std::size_t kFirstNumber = 3, kPitfall = 6;
    for (std::size_t r = 0; r < got.size(); ++r) {
        ASSERT_EQ(got[r].size(), kPitfall + 1) << r;
        ASSERT_EQ(expected[r].size(), kPitfall + 1) << r;
        for (std::size_t c = 0; c <= kPitfall; ++c)
            if (c < kFirstNumber || c == kPitfall)
                EXPECT_EQ(got[r][c], expected[r][c]);
            else
                EXPECT_TRUE(is_same_number(got[r][c], expected[r][c]))
                    << got[r][1] << ": the page says " << got[r][c] << ", measured "
                    << expected[r][c];
    }
    // Beside the table the page's text is the test's.
    EXPECT_EQ(committed.str().substr(0, committed.str().find("| case |")),
              page.substr(0, page.find("| case |")));
}

}  // namespace
}  // namespace nearfield::test
