// SPDX-License-Identifier: Apache-2.0
#include "fit/design.h"

#include <algorithm>
#include <numeric>

namespace nearfield::fit {
namespace {

// Offset of a measurement's run among an axis' runs for texel t.
std::size_t run_of(const AxisDesign& axis, int measurement_count, int t, int k) {
    return static_cast<std::size_t>((axis.texel_count == 1 ? 0 : t) * measurement_count + k);
}

double cos4(const Design& design, glm::dvec2 u_m, glm::dvec2 s_m) {
    const glm::dvec2 t = (u_m - s_m) / design.delta_m;
    const double inverse_cos2 = 1.0 + glm::dot(t, t);
    return 1.0 / (inverse_cos2 * inverse_cos2);
}

// What the texel's direction to the position puts before phi_x phi_y.
double entry_scale(const Design& design, glm::dvec2 u_m, glm::dvec2 s_m) {
    const double delta2 = design.delta_m * design.delta_m;
    if (design.sensor == Sensor::Camera && design.weighting == Weighting::Irradiance)
        return delta2 / cos4(design, u_m, s_m);
    if (design.sensor == Sensor::Pinhole && design.weighting == Weighting::Radiance)
        return design.scale * cos4(design, u_m, s_m) / delta2;
    return design.scale;
}

struct RunPair {
    std::size_t x = 0, y = 0;
};

void fill_product(const Design& design, RunPair run, double scale, int stride, double* block) {
    const double* x = &design.x.value[run.x * static_cast<std::size_t>(design.x.width)];
    const double* y = &design.y.value[run.y * static_cast<std::size_t>(design.y.width)];
    for (int b = 0; b < design.y.width; ++b, block += stride)
        for (int a = 0; a < design.x.width; ++a)
            block[a] = scale * y[b] * x[a];
}

// Sum over nodes of cos^4 / delta^2 times both axes' weights: first along x, then along y.
void fill_quadrature(const Design& design, RunPair run, glm::dvec2 s_m, int stride, double* block) {
    const auto nodes_x = static_cast<std::size_t>(design.x.node_count);
    const auto nodes_y = static_cast<std::size_t>(design.y.node_count);
    const auto width = static_cast<std::size_t>(design.x.width);
    const auto height = static_cast<std::size_t>(design.y.width);
    const double per_delta2 = 1.0 / (design.delta_m * design.delta_m);
    std::vector<double> row(width);
    for (std::size_t h = 0; h < nodes_y; ++h) {
        const std::size_t node_y = run.y * nodes_y + h;
        std::fill(row.begin(), row.end(), 0.0);
        for (std::size_t g = 0; g < nodes_x; ++g) {
            const std::size_t node_x = run.x * nodes_x + g;
            const double factor =
                per_delta2 * cos4(design, {design.x.node_m[node_x], design.y.node_m[node_y]}, s_m);
            for (std::size_t a = 0; a < width; ++a)
                row[a] += factor * design.x.node_value[node_x * width + a];
        }
        for (std::size_t b = 0; b < height; ++b) {
            const double phi = design.y.node_value[node_y * height + b];
            for (std::size_t a = 0; a < width; ++a)
                block[b * static_cast<std::size_t>(stride) + a] += phi * row[a];
        }
    }
}

void sort_by_corner(TexelDesign& texel) {
    const auto corner_of = [&](int k) {
        const int first = texel.first[static_cast<std::size_t>(k)];
        return static_cast<std::size_t>(first % texel.grid.x * texel.grid.y + first / texel.grid.x);
    };
    texel.corner_begin.assign(static_cast<std::size_t>(texel.grid.x * texel.grid.y) + 1, 0);
    for (int k = 0; k < texel.measurement_count; ++k)
        ++texel.corner_begin[corner_of(k) + 1];
    std::partial_sum(texel.corner_begin.begin(), texel.corner_begin.end(),
                     texel.corner_begin.begin());
    texel.by_corner.resize(static_cast<std::size_t>(texel.measurement_count));
    std::vector<int> next = texel.corner_begin;
    for (int k = 0; k < texel.measurement_count; ++k)
        texel.by_corner[static_cast<std::size_t>(next[corner_of(k)]++)] = k;
}

}  // namespace

bool Design::is_varying() const {
    const bool has_cos4 = (sensor == Sensor::Camera) == (weighting == Weighting::Irradiance);
    return x.texel_count > 1 || y.texel_count > 1 || has_cos4;
}

void fill_texel_design(const Design& design, int i, int j, TexelDesign& texel) {
    constexpr int kVector = 8;  // doubles of two registers, which blocks' rows fill
    texel.grid = design.grid;
    texel.measurement_count = design.measurement_count;
    texel.width = design.x.width;
    texel.height = design.y.width;
    texel.stride = (texel.width + kVector - 1) / kVector * kVector;
    texel.first.resize(static_cast<std::size_t>(design.measurement_count));
    texel.value.assign(texel.block(design.measurement_count), 0.0);
    const glm::dvec2 s_m = design.s_min_m + glm::dvec2(i + 0.5, j + 0.5) * design.texel_m;
    for (int k = 0; k < design.measurement_count; ++k) {
        const RunPair run{run_of(design.x, design.measurement_count, i, k),
                          run_of(design.y, design.measurement_count, j, k)};
        texel.first[static_cast<std::size_t>(k)] =
            design.y.first[run.y] * design.grid.x + design.x.first[run.x];
        double* block = &texel.value[texel.block(k)];
        if (design.x.node_count > 0)
            fill_quadrature(design, run, s_m, texel.stride, block);
        else
            fill_product(design, run,
                         entry_scale(design, {design.x.u_m[run.x], design.y.u_m[run.y]}, s_m),
                         texel.stride, block);
    }
    sort_by_corner(texel);
}

std::vector<double> dense(const TexelDesign& texel) {
    const int n = texel.grid.x * texel.grid.y;
    std::vector<double> matrix(static_cast<std::size_t>(texel.measurement_count * n), 0.0);
    for (int k = 0; k < texel.measurement_count; ++k)
        for (int b = 0; b < texel.height; ++b)
            for (int a = 0; a < texel.width; ++a) {
                const int m = texel.first[static_cast<std::size_t>(k)] + b * texel.grid.x + a;
                matrix[static_cast<std::size_t>(k * n + m)] =
                    texel.value[texel.block(k) + static_cast<std::size_t>(b * texel.stride + a)];
            }
    return matrix;
}

double predicted(const TexelDesign& texel, int k, const std::vector<double>& coeffs) {
    double sum = 0.0;
    for (int b = 0; b < texel.height; ++b)
        for (int a = 0; a < texel.width; ++a) {
            const int m = texel.first[static_cast<std::size_t>(k)] + b * texel.grid.x + a;
            sum += texel.value[texel.block(k) + static_cast<std::size_t>(b * texel.stride + a)] *
                   coeffs[static_cast<std::size_t>(m)];
        }
    return sum;
}

}  // namespace nearfield::fit
