// SPDX-License-Identifier: Apache-2.0
#include "formats/model/glossy_sum.h"

#include "formats/model/axis_window.h"
#include "formats/model/float_windows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace nearfield::model {
namespace {

// Distance of the nodes in units of the lobe's width, and of what else varies: the cosine and
// 1 / (1 + t^2)^2, over tangents of 1/2. A cubic through 4 nodes of exp(-x^2 / 2) errs by 3/128 * 3
// h^4.
constexpr float kNodesPerWidth = 1.0F / 0.3F;
constexpr float kWidestVariation = 0.5F;
constexpr int kMostTexelsPerNode = 64;

// Fine values reach this far beyond the texels in view: means and slopes of texels need neighbors.
constexpr int kBorder = 2;

// One axis of what all images show the receiver together.
struct FineAxis {
    FloatWindows windows;
    TexelRange range;                     // union of all windows
    float t_first = 0.0F, t_step = 0.0F;  // t at the middle of range's first texel, and of one more
    std::vector<float>
        slope;  // like windows.m0: half the first moment about a texel's middle, in texels
    int texels_per_node = 1, nodes = 0;

    int fine_count() const { return range.count + 2 * kBorder; }
    float t_of_node(int q) const {
        return t_first + static_cast<float>((q - 1) * texels_per_node - kBorder) * t_step;
    }
};

// Kept from call to call: no allocation a receiver.
struct Scratch {
    FineAxis x, y;
    std::vector<float> nodes, wide, fine, mean, weights;
    std::array<std::vector<float>, 3> column_sums;  // of each channel
};

Scratch& scratch_of_thread() {
    thread_local Scratch scratch;
    return scratch;
}

TexelRange union_of(const FloatWindows& windows) {
    TexelRange all;
    for (const FloatWindow& window : windows.of_basis) {
        if (window.range.count == 0)
            continue;
        const int first =
            all.count == 0 ? window.range.first : std::min(all.first, window.range.first);
        const int end = std::max(all.first + all.count, window.range.first + window.range.count);
        all = {first, end - first};
    }
    return all;
}

// False where no image shows the receiver anything.
bool look(FineAxis& fine, const Slab& slab, int axis_index, glm::vec3 p_m) {
    const SlabAxis<float> axis(slab, axis_index);
    fill(fine.windows, slab, axis_index, p_m[axis_index], p_m.z);
    fine.range = union_of(fine.windows);
    if (fine.range.count == 0)
        return false;
    const shared::AxisView view = shared::axis_view(p_m[axis_index], axis.delta, p_m.z);
    const auto t_of_middle = [&](int i) {
        return t_of_e(view, e_of_s(view, axis.s_min + (static_cast<float>(i) + 0.5F) * axis.texel));
    };
    fine.t_first = t_of_middle(fine.range.first);
    fine.t_step = axis.texel / p_m.z;

    fine.slope.assign(fine.windows.m0.size(), 0.0F);
    for (const FloatWindow& window : fine.windows.of_basis)
        for (int k = 0; k < window.range.count; ++k) {
            const std::size_t at = window.at + static_cast<std::size_t>(k);
            const float m0 = fine.windows.m0[at];
            const float t =
                fine.t_first +
                static_cast<float>(window.range.first + k - fine.range.first) * fine.t_step;
            // Far away t is known less well than a texel is wide: the clamp keeps the moment within
            // it.
            fine.slope[at] = 0.5F * std::clamp((fine.windows.m1[at] - t * m0) / fine.t_step,
                                               -0.5F * m0, 0.5F * m0);
        }
    return true;
}

void place_nodes(FineAxis& fine, float widest_t) {
    fine.texels_per_node = static_cast<int>(
        std::clamp(widest_t / std::abs(fine.t_step), 1.0F, static_cast<float>(kMostTexelsPerNode)));
    fine.nodes = (fine.fine_count() - 1) / fine.texels_per_node + 4;
}

// What multiplies sum C Phi dt to give reflected radiance: lobe, cosine, and radiance weighting's
// kernel.
glm::vec3 lobe_at(const GlossyReceiver& receiver, bool radiance_weighting, float t_x, float t_y) {
    const glm::vec3 to_light(t_x, t_y, -1.0F);
    const float r2 = glm::dot(to_light, to_light);
    const glm::vec3 local =
        shared::local_from_world(receiver.frame, to_light * (1.0F / std::sqrt(r2)));
    if (!(local.z > 0.0F))
        return glm::vec3(0.0F);
    const float kernel = local.z * std::sqrt(r2) / (radiance_weighting ? r2 * r2 : 1.0F);
    return shared::brdf_lobe(receiver.brdf, local, receiver.to_viewer_local) * kernel;
}

// Fills nodes [plane][node y][node x].
void evaluate_nodes(const GlossyReceiver& receiver,
                    bool radiance_weighting,
                    int planes,
                    Scratch& s) {
    const auto size = static_cast<std::size_t>(s.x.nodes) * static_cast<std::size_t>(s.y.nodes);
    s.nodes.resize(static_cast<std::size_t>(planes) * size);
    std::size_t at = 0;
    for (int b = 0; b < s.y.nodes; ++b)
        for (int a = 0; a < s.x.nodes; ++a, ++at) {
            const glm::vec3 value =
                lobe_at(receiver, radiance_weighting, s.x.t_of_node(a), s.y.t_of_node(b));
            for (int plane = 0; plane < planes; ++plane)
                s.nodes[static_cast<std::size_t>(plane) * size + at] = value[plane];
        }
}

// Weights of the values at -1, 0, 1, 2 for one at x in [0, 1): Lagrange's cubic.
std::array<float, 4> cubic_weights(float x) {
    const float a = x + 1.0F, b = x - 1.0F, c = x - 2.0F;
    return {-x * b * c / 6.0F, a * b * c / 2.0F, -a * x * c / 2.0F, a * x * b / 6.0F};
}

// From one plane of nodes to the mean over each texel in view and one around them: interpolated,
// then curvature's share (h^2 / 24 f'') added.
void spread_to_texels(const float* nodes, Scratch& s) {
    const int width = s.x.fine_count(), height = s.y.fine_count();
    const auto w = static_cast<std::size_t>(width);
    s.wide.assign(static_cast<std::size_t>(s.y.nodes) * w, 0.0F);
    for (int g = 0; g < width; ++g) {
        const int k = s.x.texels_per_node;
        const std::array<float, 4> c =
            cubic_weights(static_cast<float>(g % k) / static_cast<float>(k));
        for (int b = 0; b < s.y.nodes; ++b) {
            const float* from = nodes + std::ptrdiff_t{b} * s.x.nodes + g / k;
            s.wide[static_cast<std::size_t>(b) * w + static_cast<std::size_t>(g)] =
                c[0] * from[0] + c[1] * from[1] + c[2] * from[2] + c[3] * from[3];
        }
    }
    s.fine.resize(static_cast<std::size_t>(height) * w);
    for (int g = 0; g < height; ++g) {
        const int k = s.y.texels_per_node;
        const std::array<float, 4> c =
            cubic_weights(static_cast<float>(g % k) / static_cast<float>(k));
        const float* from = s.wide.data() + static_cast<std::size_t>(g / k) * w;
        float* to = s.fine.data() + static_cast<std::size_t>(g) * w;
#pragma omp simd
        for (std::size_t i = 0; i < w; ++i)
            to[i] = c[0] * from[i] + c[1] * from[w + i] + c[2] * from[2 * w + i] +
                    c[3] * from[3 * w + i];
    }
    s.mean.assign(s.fine.size(), 0.0F);
    for (int g = 1; g + 1 < height; ++g) {
        const float* f = s.fine.data() + static_cast<std::size_t>(g) * w;
        float* to = s.mean.data() + static_cast<std::size_t>(g) * w;
#pragma omp simd
        for (std::size_t i = 1; i < w - 1; ++i)
            to[i] =
                f[i] + (f[i - 1] + f[i + 1] + f[i - w] + f[i + w] - 4.0F * f[i]) * (1.0F / 24.0F);
    }
}

// The texels of one image that send light, and where their weights and lobe values start.
struct Part {
    TexelRange x, y;
    std::size_t x_at, y_at, mean_at;
};

Part part_of(const PreparedSlab& prepared, std::size_t m, const Scratch& s) {
    const auto columns = static_cast<std::size_t>(prepared.slab.grid.x);
    const FloatWindow& x = s.x.windows.of_basis[m % columns];
    const FloatWindow& y = s.y.windows.of_basis[m / columns];
    const glm::ivec4 lit = prepared.lit[m];
    Part part;
    part.x = intersection(x.range, {lit[0], lit[2] - lit[0]});
    part.y = intersection(y.range, {lit[1], lit[3] - lit[1]});
    part.x_at = x.at + static_cast<std::size_t>(part.x.first - x.range.first);
    part.y_at = y.at + static_cast<std::size_t>(part.y.first - y.range.first);
    part.mean_at = static_cast<std::size_t>(part.y.first - s.y.range.first + kBorder) *
                       static_cast<std::size_t>(s.x.fine_count()) +
                   static_cast<std::size_t>(part.x.first - s.x.range.first + kBorder);
    return part;
}

// Sum over the texels of image m of C times the lobe's integral with Phi, for the channels
// [first, end) that one plane of the lobe reflects.
void add_image(const PreparedSlab& prepared,
               std::size_t m,
               const Part& part,
               int first,
               int end,
               Scratch& s,
               glm::vec3& sums) {
    const Slab& slab = prepared.slab;
    const auto w = static_cast<std::ptrdiff_t>(s.x.fine_count());
    const int count = part.x.count;
    s.weights.resize(static_cast<std::size_t>(count));
    for (std::vector<float>& columns : s.column_sums)
        columns.assign(static_cast<std::size_t>(count), 0.0F);
    float* weights = s.weights.data();
    const float *x0 = s.x.windows.m0.data() + part.x_at, *x1 = s.x.slope.data() + part.x_at;
    for (int j = 0; j < part.y.count; ++j) {
        const auto at = part.y_at + static_cast<std::size_t>(j);
        const float y0 = s.y.windows.m0[at], y1 = s.y.slope[at];
        const float* f = s.mean.data() + part.mean_at + j * w;
#pragma omp simd
        for (int i = 0; i < count; ++i)
            weights[i] = x0[i] * (y0 * f[i] + y1 * (f[i + w] - f[i - w])) +
                         x1[i] * y0 * (f[i + 1] - f[i - 1]);
        for (int c = first; c < end; ++c) {
            const float* row = slab.coeffs.data() + slab.image_offset(c, static_cast<int>(m)) +
                               static_cast<std::size_t>(part.y.first + j) *
                                   static_cast<std::size_t>(slab.texels.x) +
                               static_cast<std::size_t>(part.x.first);
            float* columns = s.column_sums[static_cast<std::size_t>(c)].data();
#pragma omp simd
            for (int i = 0; i < count; ++i)
                columns[i] += row[i] * weights[i];
        }
    }
    for (int c = first; c < end; ++c)
        for (const float column : s.column_sums[static_cast<std::size_t>(c)])
            sums[c] += column;
}

float luminance(glm::vec3 rgb) {
    return static_cast<float>(kLuminanceRgb[0]) * rgb.r +
           static_cast<float>(kLuminanceRgb[1]) * rgb.g +
           static_cast<float>(kLuminanceRgb[2]) * rgb.b;
}

bool plane_cuts_view(const GlossyReceiver& receiver, const FineAxis& x, const FineAxis& y) {
    const glm::vec3 n = receiver.frame.z;
    const auto ends = [](const FineAxis& axis) {
        return glm::vec2(axis.t_first,
                         axis.t_first + static_cast<float>(axis.range.count) * axis.t_step);
    };
    const glm::vec2 t_x = ends(x) * n.x, t_y = ends(y) * n.y;
    return std::min(t_x.x, t_x.y) + std::min(t_y.x, t_y.y) - n.z < 0.0F;
}

// Fewer planes of the lobe where its color is one factor: all but GGX, whose Fresnel reflection
// differs between channels.
struct LobeColor {
    int planes = 1;
    glm::vec3 factor{1.0F};
};

LobeColor take_color(shared::Brdf& brdf) {
    const glm::vec3 color = brdf.specular;
    if (brdf.kind == shared::kBrdfGgx)
        return {color.r == color.g && color.g == color.b ? 1 : 3, glm::vec3(1.0F)};
    brdf.specular = glm::vec3(1.0F);
    return {1, color};
}

// Reflected by the lobe alone; adds each image's share of Y.
glm::vec3 reflect_by_lobe(const PreparedSlab& prepared,
                          GlossyReceiver receiver,
                          std::span<float> image_y) {
    const Slab& slab = prepared.slab;
    Scratch& s = scratch_of_thread();
    if (!look(s.x, slab, 0, receiver.position_m) || !look(s.y, slab, 1, receiver.position_m))
        return glm::vec3(0.0F);
    const bool radiance_weighting = slab.weighting == Weighting::Radiance;
    // Across its horizon the integrand has a kink that no cubic follows.
    const float width = std::min(
        shared::brdf_lobe_width_rad(receiver.brdf, receiver.to_viewer_local), kWidestVariation);
    const float widest_t = plane_cuts_view(receiver, s.x, s.y) ? 0.0F : width / kNodesPerWidth;
    place_nodes(s.x, widest_t);
    place_nodes(s.y, widest_t);
    const LobeColor color = take_color(receiver.brdf);
    evaluate_nodes(receiver, radiance_weighting, color.planes, s);

    const glm::vec3 scale =
        color.factor *
        (radiance_weighting ? 1.0F : static_cast<float>(slab.delta_m * slab.delta_m));
    glm::vec3 total(0.0F);
    const std::size_t node_count = s.nodes.size() / static_cast<std::size_t>(color.planes);
    for (int plane = 0; plane < color.planes; ++plane) {
        spread_to_texels(s.nodes.data() + static_cast<std::size_t>(plane) * node_count, s);
        for (std::size_t m = 0; m < prepared.lit.size(); ++m) {
            const Part part = part_of(prepared, m, s);
            if (part.x.count == 0 || part.y.count == 0)
                continue;
            glm::vec3 sums(0.0F);
            const bool one_channel = slab.channels == 1;
            const int first = one_channel || color.planes == 1 ? 0 : plane;
            const int end = one_channel ? 1 : color.planes == 1 ? 3 : plane + 1;
            add_image(prepared, m, part, first, end, s, sums);
            if (one_channel)
                sums = glm::vec3(sums.x);
            if (one_channel && color.planes == 3)
                sums *= glm::vec3(plane == 0, plane == 1, plane == 2);
            sums = glm::max(sums, glm::vec3(0.0F)) * scale;
            total += sums;
            if (!image_y.empty())
                image_y[m] += luminance(sums);
        }
    }
    return total;
}

}  // namespace

bool texels_resolve_lobe(const Slab& slab, const GlossyReceiver& receiver) {
    const float width = shared::brdf_lobe_width_rad(receiver.brdf, receiver.to_viewer_local);
    const auto texel_m = static_cast<float>(std::max(slab.texel_m().x, slab.texel_m().y));
    return !shared::brdf_is_glossy(receiver.brdf) ||
           texel_m <= width * std::abs(receiver.position_m.z);
}

Reflected reflect_light(const PreparedSlab& prepared,
                        const GlossyReceiver& receiver,
                        std::span<float> image_y) {
    Reflected reflected;
    reflected.irradiance =
        irradiance(prepared, ReceiverF{receiver.position_m, receiver.frame.z}, image_y);
    const glm::vec3 diffuse =
        shared::brdf_diffuse(receiver.brdf, receiver.to_viewer_local) * shared::kInversePi;
    reflected.radiance = reflected.irradiance * diffuse;
    for (float& y : image_y)
        y *= luminance(diffuse);
    const bool is_before_u = receiver.position_m.z > -static_cast<float>(prepared.slab.delta_m);
    if (is_before_u && shared::brdf_is_glossy(receiver.brdf))
        reflected.radiance += reflect_by_lobe(prepared, receiver, image_y);
    return reflected;
}

}  // namespace nearfield::model
