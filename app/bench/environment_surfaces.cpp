// SPDX-License-Identifier: Apache-2.0
// Unshadowed light of lobes: over the number of samples, over roughness along and across, of suns.
#include "app/bench/environment_scenes.h"
#include "app/bench/environment_sweep.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace nearfield::bench {

using render::EnvironmentOptions, render::FilterLevel;

void sweep_surfaces(Sweep& sweep,
                    const Mesh& mesh,
                    const std::vector<float>& exponents,
                    const std::string& study) {
    for (const float exponent : exponents) {
        const Subject subject = make_subject(sweep, scene_of(mesh, phong(exponent), sweep.picture),
                                             study, fmt::format("exponent {}", exponent));
        for (const int n : sweep.counts) {
            measure(sweep, subject, "fis", n, filtered(n, 0));
            measure(sweep, subject, "fis, suns apart", n, filtered(n, 32));
            measure(sweep, subject, "gems", n, filtered(n, 0, FilterLevel::Gems));
            measure(sweep, subject, "mfis", n, filtered(n, 0, FilterLevel::Mfis));
            measure(sweep, subject, "mfis, suns apart", n, filtered(n, 32, FilterLevel::Mfis));
            measure(sweep, subject, "unfiltered", n, filtered(n, 0, FilterLevel::None));
            EnvironmentOptions random = filtered(n, 0, FilterLevel::None);
            random.is_shifted = true;
            measure(sweep, subject, "unfiltered, random", n, random);
            measure(sweep, subject, "far lamps", n, lamps(n));
            measure_resampled(sweep, subject, n);
        }
        measure_by_error(sweep, subject);
    }
}

void sweep_counts(Sweep& sweep) {
    constexpr int kCameraSamples = 4;
    sweep.options.samples_per_pixel = kCameraSamples;
    for (const float exponent : {20.0F, 500.0F}) {
        const Subject subject =
            make_subject(sweep, scene_of(sweep.mesh, phong(exponent), sweep.picture), "counts",
                         fmt::format("exponent {}", exponent));
        for (const int n : {8, 16, 32, 64, 128})
            measure(sweep, subject, "fis, suns apart", n, filtered(n, 32));
        measure_by_error(sweep, subject);
    }
    sweep.options.samples_per_pixel = 1;
}

void sweep_brushed(Sweep& sweep) {
    const Mesh ball = make_ball(sweep.quick ? 24 : 64, 0.0);
    for (const auto& [x, y] :
         {std::pair(0.1F, 0.1F), std::pair(0.1F, 0.29F), std::pair(0.01F, 0.29F)}) {
        const Subject subject = make_subject(sweep, scene_of(ball, ward(x, y), sweep.picture),
                                             "anisotropic", fmt::format("alpha {}, {}", x, y));
        for (const int n : {50, 512}) {
            EnvironmentOptions along = filtered(n, 0);
            along.is_anisotropic = true;
            measure(sweep, subject, "fis", n, filtered(n, 0));
            measure(sweep, subject, "mfis", n, filtered(n, 0, FilterLevel::Mfis));
            measure(sweep, subject, "along the longer axis", n, along);
            measure(sweep, subject, "unfiltered", n, filtered(n, 0, FilterLevel::None));
        }
    }
}

void sweep_suns(Sweep& sweep) {
    const std::string sky = (std::filesystem::path(sweep.folder) / "sun.exr").string();
    // Columns and rows of 128 x 64, before the plate.
    const std::vector<glm::ivec2> places = {{4, 20}, {10, 31}, {124, 26}};
    for (const int height : {64, 256})
        for (const float alpha : {0.6F, 0.3F, 0.05F})
            for (std::size_t k = 0; k < (sweep.quick ? 1U : places.size()); ++k) {
                write_sun(sky, height, places[k] * (height / 64));
                const Subject subject =
                    make_subject(sweep, scene_of(make_plate(), ggx(alpha), sky), "suns",
                                 fmt::format("1 px of {} x {}, place {}, alpha {}", 2 * height,
                                             height, k + 1, alpha));
                constexpr int kSamples = 40;
                measure(sweep, subject, "fis", kSamples, filtered(kSamples, 0));
                measure(sweep, subject, "fis, suns apart", kSamples, filtered(kSamples, 32));
                measure(sweep, subject, "unfiltered", kSamples,
                        filtered(kSamples, 0, FilterLevel::None));
                measure(sweep, subject, "far lamps", kSamples, lamps(kSamples));
            }
}

}  // namespace nearfield::bench
