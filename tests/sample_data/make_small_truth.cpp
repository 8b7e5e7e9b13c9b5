// SPDX-License-Identifier: Apache-2.0
// Prints the truth of a light field that `nearfield simulate` made with the small sample's options:
//     make_small_truth headlight_small.lightfield.exr > headlight_small.truth.json
#include "tests/sample_data/small_truth.h"

#include <cstdio>

int main(int argument_count, char** arguments) {
    if (argument_count != 2) {
        std::fputs("usage: make_small_truth headlight_small.lightfield.exr\n", stderr);
        return 2;
    }
    const auto truth = nearfield::support::small_truth(
        nearfield::sample_data::make_headlight(nearfield::support::small_options().seed),
        nearfield::read_lightfield(arguments[1]));
    std::puts(truth.dump(1).c_str());
}
