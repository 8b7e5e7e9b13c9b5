// SPDX-License-Identifier: Apache-2.0
/// The cases in which a lamp's light is hard to compute in float, each with the numbers that were
/// measured. hard_cases_test.cpp checks them and writes them as docs/hard_cases.md.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::test {

/// A measured quantity; all are errors or counts, of which none may exceed `required`.
struct HardRow {
    std::string quantity;
    double required = 0;
    std::optional<double> in_float, in_double;
    std::optional<double> naive = std::nullopt;  // what the obvious way gives in float, unlimited
};

struct HardCase {
    std::string name;     // of the test
    std::string title;    // in the table
    std::string pitfall;  // what goes wrong naively
    std::function<std::vector<HardRow>()> measure;
};

/// For GoogleTest's lists of tests.
std::ostream& operator<<(std::ostream& stream, const HardCase& hard_case);

/// Of the sums by receiver (hard_cases_sums.cpp) and by lamp (hard_cases_lamps.cpp), of tables and
/// samplers (hard_cases_sampling.cpp), of files and scenes (hard_cases_files.cpp).
std::vector<HardCase> sum_cases();
std::vector<HardCase> lamp_cases();
std::vector<HardCase> sampling_cases();
std::vector<HardCase> file_cases();

std::vector<HardCase> all_hard_cases();

/// docs/hard_cases.md with these numbers in its table.
std::string hard_cases_page(const std::vector<std::vector<HardRow>>& measured);

/// The table's cells, line by line, of a page.
std::vector<std::vector<std::string>> table_of(const std::string& page);

}  // namespace nearfield::test
