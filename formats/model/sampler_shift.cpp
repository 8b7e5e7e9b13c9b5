// SPDX-License-Identifier: Apache-2.0
// Shifts of points from pixel to pixel, and the tile of blue noise.
#include "formats/model/sampler_draws.h"
#include "formats/shared/rng.glsl.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::model {
namespace {

constexpr int kTile = kBlueNoiseTile;
constexpr int kTexels = kTile * kTile;

using Tile = std::array<float, kTexels>;

// A pattern of points on a torus, and how crowded each place is: the sum over points of a Gaussian
// of sigma 1.5 texels, Ulichney's choice.
struct Pattern {
    std::array<bool, kTexels> is_set{};
    std::array<float, kTexels> crowding{};
    std::array<float, kTexels> gaussian{};

    Pattern() {
        for (int k = 0; k < kTexels; ++k) {
            const int dx = std::min(k % kTile, kTile - k % kTile);
            const int dy = std::min(k / kTile, kTile - k / kTile);
            gaussian[static_cast<std::size_t>(k)] =
                std::exp(-static_cast<float>(dx * dx + dy * dy) / (2.0F * 1.5F * 1.5F));
        }
    }

    void set(int at, bool value) {
        is_set[static_cast<std::size_t>(at)] = value;
        const float sign = value ? 1.0F : -1.0F;
        const int x = at % kTile, y = at / kTile;
        for (int j = 0; j < kTile; ++j) {
            const int row = (j - y + kTile) % kTile * kTile;
            for (int i = 0; i < kTile; ++i)
                crowding[static_cast<std::size_t>(j * kTile + i)] +=
                    sign * gaussian[static_cast<std::size_t>(row + (i - x + kTile) % kTile)];
        }
    }

    // The most crowded point (value: true), or the emptiest place (false); the first of equals.
    int extreme(bool value) const {
        int best = -1;
        for (int k = 0; k < kTexels; ++k) {
            const auto at = static_cast<std::size_t>(k);
            if (is_set[at] != value)
                continue;
            const float crowd = crowding[at];
            if (best < 0 || (value ? crowd > crowding[static_cast<std::size_t>(best)]
                                   : crowd < crowding[static_cast<std::size_t>(best)]))
                best = k;
        }
        return best;
    }
};

// Ulichney, "The void-and-cluster method for dither array generation", 1993: places ranked so that
// those below any rank are spread evenly. Values are (rank + 1/2) / 4096.
Tile make_tile(std::uint32_t seed) {
    Pattern first;
    constexpr int kPoints = kTexels / 10;
    for (std::uint32_t k = 0, count = 0; count < kPoints; ++k) {
        const auto at =
            static_cast<int>(shared::hash4({k, seed, 0U, 0U}).x % static_cast<unsigned>(kTexels));
        if (first.is_set[static_cast<std::size_t>(at)])
            continue;
        first.set(at, true);
        ++count;
    }
    // Move the most crowded point into the largest void until that is where it came from.
    for (int cluster = first.extreme(true), void_at = -1; cluster != void_at;
         cluster = first.extreme(true)) {
        first.set(cluster, false);
        void_at = first.extreme(false);
        first.set(void_at, true);
    }
    Tile tile{};
    const auto rank = [&](int at, int value) {
        tile[static_cast<std::size_t>(at)] = (static_cast<float>(value) + 0.5F) / kTexels;
    };
    Pattern pattern = first;
    for (int r = kPoints - 1; r >= 0; --r) {
        const int cluster = pattern.extreme(true);
        pattern.set(cluster, false);
        rank(cluster, r);
    }
    pattern = first;
    for (int r = kPoints; r < kTexels; ++r) {
        const int void_at = pattern.extreme(false);
        pattern.set(void_at, true);
        rank(void_at, r);
    }
    return tile;
}

}  // namespace

const std::vector<glm::vec2>& blue_noise_tile() {
    static const std::vector<glm::vec2> interleaved = [] {
        const Tile x = make_tile(1), y = make_tile(2);
        std::vector<glm::vec2> tile;
        for (std::size_t k = 0; k < x.size(); ++k)
            tile.emplace_back(x[k], y[k]);
        return tile;
    }();
    return interleaved;
}

glm::vec2 shift_of(Shift shift, glm::uvec2 pixel, std::uint32_t pass, std::uint32_t seed) {
    glm::vec2 noise(0.0F);
    if (shift == Shift::BlueNoise)
        noise = blue_noise_tile()[pixel.y % kTile * kTile + pixel.x % kTile];
    return shared::pixel_shift(word_of(shift), pixel, pass, seed, noise);
}

}  // namespace nearfield::model
