// SPDX-License-Identifier: Apache-2.0
#include "tests/model/hard_cases.h"

#include <fmt/format.h>

#include <sstream>

namespace nearfield::test {
namespace {

constexpr const char* kIntroduction =
    R"(# Hard cases

Where a lamp's light is hard to compute in single precision, what the obvious way does there, what is required, and what was
measured. A test measures and writes this table, checks every number against `required`, and compares this page with what it
measured:

    cmake --build --preset release --target hard_cases_test && ctest --test-dir build/release -R HardCasesPage; cp build/release/test_output/hard_cases_test/hard_cases.md docs/

- *float*: the sums, tables and samplers that renderers call. *double*: the sum that `probe` prints. *naive*: the obvious way in
  float, where it is easily had.
- Errors are the worst over receivers of every kind (facing, tilted, cut by the receiver's plane, at S's border, beside it,
  back-facing), all five bases where nothing else is said, coefficients over four powers of ten with dark texels between;
  against quadrature in double of the definition (`tests/support/oracle.h`) at the very point that float represents. Where that is 0 so
  must be the result.
- C_m jumps at texels' edges, and near S so does the truth: receivers there look at the middle half of a texel.
- z: how far a sampler's mean is off, in standard errors, worst of `systematic` and `cells`, three heights and the counts named;
  its limit is Šidák's at 3 sigma for the whole case. Positions are tested by chi-square in `tests/model`, on whole images, on a dark window and
  over a range of 1e10; the z-tests of a full-size lamp are there too.

)";

std::string cell(const std::optional<double>& value) {
    return value ? fmt::format("{:.2g}", *value) : "–";
}

}  // namespace

std::ostream& operator<<(std::ostream& stream, const HardCase& hard_case) {
    return stream << hard_case.name;
}

std::vector<HardCase> all_hard_cases() {
    std::vector<HardCase> all = sum_cases();
    for (const std::vector<HardCase>& more : {lamp_cases(), sampling_cases(), file_cases()})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

std::string hard_cases_page(const std::vector<std::vector<HardRow>>& measured) {
    std::string page = kIntroduction;
    page += "| case | quantity | required | float | double | naive | what goes wrong naively |\n";
    page += "| --- | --- | --- | --- | --- | --- | --- |\n";
    const std::vector<HardCase> cases = all_hard_cases();
    for (std::size_t k = 0; k < cases.size(); ++k)
        for (std::size_t r = 0; r < measured[k].size(); ++r) {
            const HardRow& row = measured[k][r];
            page +=
                fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", r == 0 ? cases[k].title : "",
                            row.quantity, cell(row.required), cell(row.in_float),
                            cell(row.in_double), cell(row.naive), r == 0 ? cases[k].pitfall : "");
        }
    return page;
}

std::vector<std::vector<std::string>> table_of(const std::string& page) {
    std::vector<std::vector<std::string>> table;
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("| "))
            continue;
        std::vector<std::string> cells;
        std::size_t begin = 2;
        for (std::size_t end = line.find(" |", begin); end != std::string::npos;
             end = line.find(" |", begin)) {
            cells.push_back(line.substr(begin, end - begin));
            begin = std::min(end + 3, line.size());
        }
        table.push_back(std::move(cells));
    }
    return table;
}

}  // namespace nearfield::test
