// SPDX-License-Identifier: Apache-2.0
#include "fit/texel_data.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::fit {

TileLayout tile_layout(const Design& design, int channels, TileRange rows) {
    return {static_cast<std::size_t>(design.texels.x), static_cast<std::size_t>(rows.row_count),
            static_cast<std::size_t>(design.measurement_count),
            static_cast<std::size_t>(design.basis_count()), static_cast<std::size_t>(channels)};
}

bool read_texel(const TileInput& input,
                const TileLayout& layout,
                std::size_t channel,
                std::size_t row,
                std::size_t i,
                double model_error_rel,
                TexelData& data) {
    data.b.assign(layout.measurements, 0.0);
    data.weight.assign(layout.measurements, 0.0);
    data.noise_share.assign(layout.measurements, 1.0);
    double brightest = 0.0;
    bool has_data = false;
    for (std::size_t k = 0; k < layout.measurements; ++k) {
        const std::size_t at = layout.at(channel, k, layout.measurements, row, i);
        const auto variance = double(input.variance[at]);
        if (!(variance > 0.0))
            throw Error{"bad measurement",
                        fmt::format("channel {}, position {}, row {} of a tile, column {}", channel,
                                    k, row, i),
                        "variance > 0", fmt::format("{}", variance)};
        if (std::isinf(variance))
            continue;
        data.b[k] = double(input.value[at]);
        data.weight[k] = 1.0 / variance;
        brightest = std::max(brightest, data.b[k]);
        has_data = true;
    }
    const double error = model_error_rel * brightest;
    for (std::size_t k = 0; error > 0.0 && k < layout.measurements; ++k) {
        data.noise_share[k] = 1.0 / (1.0 + error * error * data.weight[k]);
        data.weight[k] *= data.noise_share[k];
    }
    return has_data;
}

}  // namespace nearfield::fit
