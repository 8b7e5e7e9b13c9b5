// SPDX-License-Identifier: Apache-2.0
#include "formats/model/luminaire.h"
#include "sample_data/reference_lamp.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/receivers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace nearfield::sample_data {
namespace {

const std::string kReceiversFile = NEARFIELD_SOURCE_DIR "/../shared/examples/model/receivers.csv";

// The columns of a CSV file with numbers only, [row][column], without its header.
std::vector<std::vector<double>> read_numbers(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(file, line)) {
        std::vector<double> row;
        for (std::size_t at = 0; at != std::string::npos && at < line.size();) {
            row.push_back(std::stod(line.substr(at)));
            const std::size_t comma = line.find(',', at);
            at = comma == std::string::npos ? comma : comma + 1;
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

TEST(ReferenceLamp, EqualsTheTestsOwn) {
    // The tests' support builds the same lamp from its definition apart from sample_data.
    const std::vector<double> mine = reference_coeffs(), theirs = support::reference_lamp_coeffs();
    ASSERT_EQ(mine.size(), theirs.size());
    for (std::size_t k = 0; k < mine.size(); ++k) {
        ASSERT_NEAR(mine[k], theirs[k], 1e-13 * std::abs(theirs[k])) << "coefficient " << k;
    }
    EXPECT_EQ(make_reference_lamp().slabs.front().coeffs, support::reference_lamp().coeffs);
}

TEST(ReferenceLamp, ReproducesTheReceiversIrradiance) {
    // Receivers equal to the file's; irradiance by brute force to 1e-9 with coefficients in double,
    // and to 1e-7 with those of the file format, which are floats (2^-25 each, averaged over
    // thousands of texels).
    if (!std::filesystem::exists(kReceiversFile)) {
        GTEST_SKIP() << "no receivers.csv beside the project";
    }
    constexpr double kDouble = 1e-9, kFloat = 1e-8;
    // Where the receiver's plane cuts the lens, the file's own quadrature clamps per node: one
    // receiver of 300.
    constexpr double kCut = 1e-7;
    const std::vector<std::vector<double>> rows = read_numbers(kReceiversFile);
    const std::vector<model::Receiver> receivers = reference_receivers();
    const LightField lamp = make_reference_lamp();
    const std::vector<double> coeffs = reference_coeffs();
    const std::vector<glm::dvec3> exact =
        support::oracle_irradiance(lamp.slabs.front(), receivers, {8, coeffs});
    ASSERT_EQ(rows.size(), receivers.size());
    double worst_double = 0.0, worst_float = 0.0;
    int cut_count = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t column = static_cast<std::size_t>(axis);
            ASSERT_DOUBLE_EQ(receivers[k].position_m[axis], rows[k][column]);
            ASSERT_NEAR(receivers[k].normal[axis], rows[k][3 + column], 1e-15);
        }
        const double expected = rows[k][6];
        const support::FacingRange facing = support::facing_range(lamp.slabs.front(), receivers[k]);
        const double from_floats = model::irradiance(lamp, receivers[k]).x;
        if (facing.low_m < 0.0) {
            ++cut_count;
            EXPECT_NEAR(exact[k].x, expected, kCut * expected);
        } else if (expected > 0.0) {
            worst_double = std::max(worst_double, std::abs(exact[k].x / expected - 1.0));
            worst_float = std::max(worst_float, std::abs(from_floats / expected - 1.0));
        }
    }
    RecordProperty("cut_count", cut_count);
    EXPECT_LT(worst_double, kDouble);
    EXPECT_LT(worst_float, kFloat);
    RecordProperty("worst_double_1e-12", std::to_string(worst_double * 1e12));
    RecordProperty("worst_float_1e-12", std::to_string(worst_float * 1e12));
    EXPECT_EQ(cut_count, 10);
}

}  // namespace
}  // namespace nearfield::sample_data
