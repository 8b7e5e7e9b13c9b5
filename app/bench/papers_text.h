// SPDX-License-Identifier: Apache-2.0
/// What the paper's text states, for the page of `bench papers`: nothing here is read off a plot or
/// a picture.
#pragma once

#include "app/bench/papers.h"

#include <string>
#include <vector>

namespace nearfield::bench {

struct FigureText {
    const char* figure;
    const char* title;
    const char* paper;  // what the paper states
    const char* here;   // what was measured
};

/// In the page's order.
const std::vector<FigureText>& figure_texts();

/// The number that the paper's text gives for such a setting; empty where it gives none.
std::string stated(const PapersRow& row);

/// What follows from a figure's rows, in sentences with their numbers.
std::vector<std::string> conclusions(const PapersFindings& findings, const std::string& figure);

}  // namespace nearfield::bench
