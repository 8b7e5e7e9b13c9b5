// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/text_numbers.h"

#include <charconv>
#include <system_error>

namespace nearfield::rays {
namespace {

bool is_between(char character) {
    return character == ' ' || character == '\t' || character == ',' || character == '\r';
}

// Calls use(number) for every number of a line; false where something else stands there.
template <typename Number, typename Use>
bool for_each_number(std::string_view line, const Use& use) {
    const char* at = line.data();
    const char* end = at + line.size();
    while (true) {
        while (at != end && is_between(*at))
            ++at;
        if (at == end)
            return true;
        if (*at == '+')  // other programs write it, from_chars does not take it
            ++at;
        Number number{};
        const auto [next, failure] = std::from_chars(at, end, number);
        // Too small for the type (1e-300) is 0 for us; too large is not a number.
        if (failure == std::errc::result_out_of_range) {
            double wide = 0;
            if (std::from_chars(at, end, wide).ec != std::errc{} || wide > 1 || wide < -1)
                return false;
            number = 0;
        } else if (failure != std::errc{} || (next != end && !is_between(*next))) {
            return false;
        }
        use(number);
        at = next;
    }
}

}  // namespace

std::optional<std::vector<double>> numbers_of(std::string_view line) {
    std::vector<double> numbers;
    if (!for_each_number<double>(line, [&](double number) { numbers.push_back(number); }))
        return std::nullopt;
    return numbers;
}

int parse_numbers(std::string_view line, float* numbers, int most) {
    int count = 0;
    const bool is_well = for_each_number<float>(line, [&](float number) {
        if (count < most)
            numbers[count] = number;
        ++count;
    });
    return is_well ? count : -1;
}

}  // namespace nearfield::rays
