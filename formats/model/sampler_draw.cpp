// SPDX-License-Identifier: Apache-2.0
#include "formats/model/profile.h"
#include "formats/model/sampler.h"
#include "formats/model/sampler_draws.h"
#include "formats/model/sampler_window.h"

#include <algorithm>
#include <optional>

namespace nearfield::model {
namespace {

// What energies count: an image, or one cell of its support.
struct Part {
    int image, cell_x, cell_y;
    float mean_basis;  // by which its energy was weighted
};

Part part_of(const Slab& slab, Sampler sampler, std::size_t entry) {
    if (sampler != Sampler::Cells)
        return {static_cast<int>(entry), 0, 0, 1.0F};
    const std::size_t n = slab.profile.cells.size();
    const std::size_t cell = entry % (n * n), cy = cell / n, cx = cell % n;
    return {static_cast<int>(entry / (n * n)), static_cast<int>(cx), static_cast<int>(cy),
            static_cast<float>(integral(slab.profile, cx) * integral(slab.profile, cy))};
}

// The point at two coordinates of one part, and its light for an estimate of which every sample
// stands for `share` of the energy; nothing where it sends none.
void add_sample(const Drawing& drawing,
                std::size_t slab_index,
                const Window& window,
                glm::vec2 coordinates,
                float share) {
    const SamplingSlab& slab = drawing.slabs[slab_index];
    SamplingView& view = drawing.views[slab_index];
    const std::optional<TexelPoint> point = pick_point(slab, view, window, coordinates);
    if (!point)
        return;
    const AperturePoint at = aperture_point(view, window.x, window.y, *point);
    const float kernel = light_kernel(slab.prepared.slab, view, window.image, at);
    if (!(kernel > 0.0F))
        return;
    drawing.samples.push_back(
        {at.u_m, static_cast<int>(slab_index), window.image,
         chroma(slab.prepared.slab, view, window.image, point->texel) * (share * kernel)});
}

}  // namespace

LampEnergy lamp_energy(std::span<const SamplingView> views) {
    LampEnergy lamp;
    for (const SamplingView& view : views)
        for (const float energy : view.energy) {
            lamp.total += static_cast<double>(energy);
            lamp.lit += energy > 0.0F ? 1 : 0;
        }
    return lamp;
}

void draw_systematic(const Drawing& drawing) {
    const SamplerOptions& options = drawing.options;
    // Which image: one stratified coordinate across all of them. Where in it: Cells go on with what
    // the coordinate leaves of a cell's energy. In whole images Phi rises and falls, and of most
    // only one sample or two are drawn: their positions are stratified across images, as points of
    // the plane, for which the choice of image takes a shift of its own. Fibonacci's points rise
    // with q as images do, so they go on with the rest too.
    const bool by_rest =
        options.sampler == Sampler::Cells || options.sequence == Sequence::Fibonacci;
    const float start = by_rest ? drawing.shift.x : shared::third_shift(drawing.shift);
    const double total = lamp_energy(drawing.views).total;
    const auto count = static_cast<std::uint32_t>(options.samples);
    const auto share = static_cast<float>(total / count);
    std::uint32_t q = 0;
    const auto target = [&] { return shared::stratum_target(q, start, count, total); };
    double sum = 0.0;
    for (std::size_t k = 0; k < drawing.slabs.size(); ++k) {
        const SamplingSlab& slab = drawing.slabs[k];
        SamplingView& view = drawing.views[k];
        for (std::size_t entry = 0; entry < view.energy.size(); ++entry) {
            const double energy = view.energy[entry], before = sum;
            sum += energy;
            if (q == count || !(target() < sum))
                continue;
            const Part part = part_of(slab.prepared.slab, options.sampler, entry);
            const glm::ivec2 grid = slab.prepared.slab.grid;
            const Window window =
                open_window(slab, view, options.precision, part.image,
                            view.x[static_cast<std::size_t>(part.image % grid.x + part.cell_x)],
                            view.y[static_cast<std::size_t>(part.image / grid.x + part.cell_y)]);
            for (; q < count && target() < sum; ++q) {
                const auto rest = static_cast<float>((target() - before) / energy);
                const glm::vec2 point =
                    by_rest ? glm::vec2(std::min(rest, shared::kBelowOne),
                                        second_coordinate(options.sequence, q, drawing.shift))
                            : plane_point(options.sequence, q, count, drawing.shift);
                add_sample(drawing, k, window, point, share / part.mean_basis);
            }
        }
    }
}

void draw(std::span<const SamplingSlab> slabs,
          std::span<SamplingView> views,
          const SamplerOptions& options,
          glm::vec2 shift,
          std::vector<LightSample>& samples) {
    samples.clear();
    const Drawing drawing{slabs, views, options, shift, samples};
    switch (options.sampler) {
        case Sampler::Uniform:
            return draw_uniform(drawing);
        case Sampler::Precomputed:
            return draw_precomputed(drawing);
        case Sampler::Pdis:
            return draw_pdis(drawing);
        case Sampler::Systematic:
        case Sampler::Cells:
            return draw_systematic(drawing);
    }
}

glm::vec3 irradiance_by_sampler(std::span<const SamplingSlab> slabs,
                                std::span<const ReceiverF> receiver_in_slab,
                                const SamplerOptions& options,
                                glm::vec2 shift,
                                std::span<SamplingView> views,
                                std::vector<LightSample>& samples) {
    for (std::size_t k = 0; k < slabs.size(); ++k)
        look(slabs[k], receiver_in_slab[k], options, views[k]);
    draw(slabs, views, options, shift, samples);
    // In double: a million equal floats added in float would lose a thousandth of their sum.
    glm::dvec3 sum(0.0);
    for (const LightSample& sample : samples)
        sum += glm::dvec3(sample.light);
    return glm::vec3(sum);
}

}  // namespace nearfield::model
