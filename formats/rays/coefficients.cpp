// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/coefficients.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

namespace nearfield::rays {
namespace {

// The parts of a texel's flux that the basis functions carry: [channel][m]; the first channel sums
// to one.
std::vector<double> shares_of_texel(const std::vector<BlockShares>& fits, glm::dvec2 s_m) {
    // A texel that the kernel lights beyond all lit blocks takes the shares of a coarser level, at
    // last of all of S.
    for (auto fit = fits.rbegin(); fit != fits.rend(); ++fit) {
        const BlockWeights at = weights_at(fit->blocks, fit->s, s_m);
        double flux = 0.0;
        for (int k = 0; k < 4; ++k)
            flux += at.weight[k] * fit->block_flux[at.block[k]];
        if (!(flux > 0.0))
            continue;
        std::vector<double> shares(static_cast<std::size_t>(fit->channels * fit->images));
        for (int k = 0; k < 4; ++k)
            for (std::size_t i = 0; i < shares.size(); ++i)
                shares[i] += at.weight[k] / flux * fit->flux[fit->offset(at.block[k], 0) + i];
        return shares;
    }
    return {};
}

// What a channel of the slab takes of the shares: a channel of them and a factor.
struct ChannelSource {
    int share_channel = 0;
    double factor = 1.0;
};

std::vector<ChannelSource> channel_sources(const std::vector<glm::vec3>& colors) {
    if (colors.empty())
        return {{}};
    if (colors.size() == 1)
        return {{0, colors[0].r}, {0, colors[0].g}, {0, colors[0].b}};
    return {{1, 1.0}, {2, 1.0}, {3, 1.0}};
}

}  // namespace

Slab make_slab(const Planes& planes,
               const Planes& first,
               const Aperture& aperture,
               const TexelGrid& texels) {
    Slab slab;
    slab.luminaire_from_slab.rotation = planes.file_from_slab;
    slab.luminaire_from_slab.translation_m =
        planes.file_from_slab[2] * planes.s_m - glm::dvec3(0.0, 0.0, first.s_m);
    slab.delta_m = planes.s_m - planes.u_m;
    slab.grid = aperture.grid;
    slab.pitch_m = aperture.pitch_m;
    slab.u_center_m = aperture.center_m;
    slab.texels = texels.texels;
    slab.s_min_m = texels.rectangle.min_m;
    slab.s_max_m = texels.rectangle.max_m;
    slab.profile = aperture.profile;
    slab.weighting = Weighting::Irradiance;
    return slab;
}

// c_m(texel) = flux of the texel * share of m / (texel area * integral of Phi).
// sigma_m^2 = variance of the texel's flux * share of m / (...)^2: adds up to the texel's variance
// over m.
void fill(Slab& slab,
          const TexelGrid& grid,
          const TexelFlux& flux,
          const std::vector<BlockShares>& fits,
          const std::vector<glm::vec3>& colors) {
    const std::vector<ChannelSource> sources = channel_sources(colors);
    slab.channels = static_cast<int>(sources.size());
    const auto images = static_cast<std::size_t>(slab.image_count());
    slab.coeffs.assign(sources.size() * images * slab.texel_count(), 0.0F);
    slab.sigma.assign(slab.coeffs.size(), 0.0F);
    const double unit =
        grid.size_m().x * grid.size_m().y *
        Aperture{slab.profile, slab.grid, slab.pitch_m, slab.u_center_m}.integral_m2();
    tbb::parallel_for(std::size_t{0}, slab.texel_count(), [&](std::size_t t) {
        if (!(flux.flux[t] > 0.0))
            return;
        const auto width = static_cast<std::size_t>(slab.texels.x);
        const std::size_t column = t % width, row = t / width;
        const glm::dvec2 texel(static_cast<double>(column), static_cast<double>(row));
        const std::vector<double> shares =
            shares_of_texel(fits, slab.s_min_m + (texel + 0.5) * grid.size_m());
        for (std::size_t m = 0; m < images; ++m) {
            // Channels' errors are one error, the rays', shared out like the color: Y's sigma is
            // the channels' weighted sum.
            double y = 0.0;
            std::array<double, 3> c{};
            for (std::size_t k = 0; k < sources.size(); ++k) {
                c[k] = sources[k].factor *
                       shares[static_cast<std::size_t>(sources[k].share_channel) * images + m];
                y += (sources.size() == 1 ? 1.0 : kLuminanceRgb[k]) * c[k];
            }
            if (!(y > 0.0))
                continue;
            const double sigma = std::sqrt(flux.variance_as_independent[t] * y) / unit;
            for (std::size_t k = 0; k < sources.size(); ++k) {
                const std::size_t i =
                    slab.image_offset(static_cast<int>(k), static_cast<int>(m)) + t;
                slab.coeffs[i] = static_cast<float>(flux.flux[t] * c[k] / unit);
                slab.sigma[i] = static_cast<float>(sigma * c[k] / y);
            }
        }
    });
}

}  // namespace nearfield::rays
