// SPDX-License-Identifier: Apache-2.0
#include "sample_data/project.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "sample_data/basis_solve.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <string>
#include <vector>

namespace nearfield::sample_data {
namespace {

// Every kProbeStep-th row of S is integrated with twice the nodes as well, to measure the
// quadrature's error.
constexpr int kProbeStep = 32;

// What is refused before time and memory are spent: Gram matrices are inverted densely (cubic in
// the grid's edge), and all coefficients are kept (4 GiB).
constexpr int kMostFunctions = 512;
constexpr double kMostCoeffs = 1 << 30;

// The quadrature of all rows of S.
struct Nodes {
    std::vector<ApertureRow> rows;
    std::vector<std::vector<Term>> terms_y;               // [row]
    std::vector<std::vector<std::vector<Term>>> terms_x;  // [row][node]
    std::vector<Node> in_texel;                           // on [0, 1], weights sum to 1
};

Nodes make_nodes(
    const Source& source, const Slab& planes, const Axis& axis_x, const Axis& axis_y, int refine) {
    Aperture aperture = source.aperture;
    const std::vector<double> edges_x = axis_x.cell_edges_m(), edges_y = axis_y.cell_edges_m();
    aperture.breaks_x_m.insert(aperture.breaks_x_m.end(), edges_x.begin(), edges_x.end());
    aperture.breaks_y_m.insert(aperture.breaks_y_m.end(), edges_y.begin(), edges_y.end());
    // What varies within a texel of s varies as fast with u. Sharp edges lie along x: half the
    // nodes do there.
    const glm::dvec2 spacing_m =
        glm::max(planes.texel_m(), glm::dvec2(1e-4)) * glm::dvec2(2.0, 1.0) / double(refine);
    Nodes nodes;
    nodes.rows = aperture_rows(aperture, spacing_m);
    for (const ApertureRow& row : nodes.rows) {
        nodes.terms_y.push_back(terms_at(axis_y, row.y.at_m));
        std::vector<std::vector<Term>> terms_x;
        for (const Node& x : row.x) {
            terms_x.push_back(terms_at(axis_x, x.at_m));
        }
        nodes.terms_x.push_back(std::move(terms_x));
    }
    nodes.in_texel = gauss_nodes(0.0, 1.0, {}, 0.5 / refine, 2);
    return nodes;
}

// What one row of S's texels needs: data b[channel][m][i], the mean of f and of the flux density's
// integrals over U.
struct RowData {
    std::vector<double> b;         // [channel][m][i]
    std::vector<double> integral;  // [channel][i]: integral of f over U
    double flux = 0;               // Y of the row's texels
};

class RowIntegrator {
  public:
    RowIntegrator(const Source& source, const Slab& planes, const Nodes& nodes)
        : source_(source),
          planes_(planes),
          nodes_(nodes),
          width_(static_cast<std::size_t>(planes.texels.x)),
          channels_(static_cast<std::size_t>(planes.channels)) {
        const double texel_m = planes.texel_m().x;
        for (const Node& node : nodes.in_texel) {
            for (std::size_t i = 0; i < width_; ++i) {
                s_x_m_.push_back(planes.s_min_m.x + (static_cast<double>(i) + node.at_m) * texel_m);
            }
        }
        rgb_.resize(3 * s_x_m_.size());
        mean_.resize(channels_ * width_);
        factor_.resize(width_);
        luminance_.resize(width_);
        density_sum_.resize(width_);
    }

    RowData integrate(int j) {
        const std::size_t images = static_cast<std::size_t>(planes_.image_count());
        const std::size_t columns = static_cast<std::size_t>(planes_.grid.x);
        RowData data;
        data.b.assign(channels_ * images * width_, 0.0);
        data.integral.assign(channels_ * width_, 0.0);
        std::vector<double> line(channels_ * columns * width_);
        for (std::size_t r = 0; r < nodes_.rows.size(); ++r) {
            const ApertureRow& row = nodes_.rows[r];
            std::fill(line.begin(), line.end(), 0.0);
            for (std::size_t n = 0; n < row.x.size(); ++n) {
                average_texels({row.x[n].at_m, row.y.at_m}, j, row.x[n].weight_m * row.y.weight_m,
                               data);
                for (const Term& term : nodes_.terms_x[r][n]) {
                    add(line, columns, static_cast<std::size_t>(term.index),
                        term.value * row.x[n].weight_m, mean_, 1, 0);
                }
                for (std::size_t k = 0; k < mean_.size(); ++k) {
                    data.integral[k] += row.x[n].weight_m * row.y.weight_m * mean_[k];
                }
            }
            for (const Term& term : nodes_.terms_y[r]) {
                for (std::size_t column = 0; column < columns; ++column) {
                    add(data.b, images, static_cast<std::size_t>(term.index) * columns + column,
                        term.value * row.y.weight_m, line, columns, column);
                }
            }
        }
        return data;
    }

  private:
    // to[channel][to_index][i] += factor * from[channel][from_index][i]
    void add(std::vector<double>& to,
             std::size_t to_count,
             std::size_t to_index,
             double factor,
             const std::vector<double>& from,
             std::size_t from_count,
             std::size_t from_index) const {
        for (std::size_t channel = 0; channel < channels_; ++channel) {
            double* const target = to.data() + (channel * to_count + to_index) * width_;
            const double* const origin = from.data() + (channel * from_count + from_index) * width_;
            for (std::size_t i = 0; i < width_; ++i) {
                target[i] += factor * origin[i];
            }
        }
    }

    // Adds column q of the row's nodes, each its texel's `share`, to mean_ and density_sum_.
    void add_node(glm::dvec2 u_m, double s_y_m, std::size_t q, double share) {
        const double inverse_square = 1.0 / (planes_.delta_m * planes_.delta_m);
        const double t_y_square = (s_y_m - u_m.y) * (s_y_m - u_m.y) * inverse_square;
        const bool is_irradiance = planes_.weighting == Weighting::Irradiance;
        const std::size_t count = s_x_m_.size();
        for (std::size_t i = 0; i < width_; ++i) {
            const std::size_t k = q * width_ + i;
            const double t_x_m = s_x_m_[k] - u_m.x;
            const double secant = 1.0 + t_x_m * t_x_m * inverse_square + t_y_square;
            const double density = share * inverse_square / (secant * secant);
            factor_[i] = is_irradiance ? density : share;
            luminance_[i] = kLuminanceRgb[0] * rgb_[k] + kLuminanceRgb[1] * rgb_[count + k] +
                            kLuminanceRgb[2] * rgb_[2 * count + k];
            density_sum_[i] += density * luminance_[i];
        }
        for (std::size_t channel = 0; channel < channels_; ++channel) {
            const double* const value =
                channels_ == 1 ? luminance_.data() : &rgb_[channel * count + q * width_];
            for (std::size_t i = 0; i < width_; ++i) {
                mean_[channel * width_ + i] += factor_[i] * value[i];
            }
        }
    }

    // mean_[channel][i]: the texel's mean of f(u); adds the texels' flux.
    void average_texels(glm::dvec2 u_m, int j, double weight_m2, RowData& data) {
        std::fill(mean_.begin(), mean_.end(), 0.0);
        const glm::dvec2 texel_m = planes_.texel_m();
        std::fill(density_sum_.begin(), density_sum_.end(), 0.0);
        for (const Node& in_texel : nodes_.in_texel) {
            const double s_y_m = planes_.s_min_m.y + (j + in_texel.at_m) * texel_m.y;
            source_.radiance_row(u_m, s_y_m, s_x_m_, rgb_);
            for (std::size_t q = 0; q < nodes_.in_texel.size(); ++q) {
                add_node(u_m, s_y_m, q, in_texel.weight_m * nodes_.in_texel[q].weight_m);
            }
        }
        const double row_flux = std::accumulate(density_sum_.begin(), density_sum_.end(), 0.0);
        data.flux += row_flux * weight_m2 * texel_m.x * texel_m.y;
    }

    const Source& source_;
    const Slab& planes_;
    const Nodes& nodes_;
    std::size_t width_, channels_;
    std::vector<double> s_x_m_;                             // [node in texel][i]
    std::vector<double> rgb_;                               // [channel][node in texel][i]
    std::vector<double> mean_;                              // [channel][i]
    std::vector<double> factor_, luminance_, density_sum_;  // [i]
};

// Squared norms over a row: of the data, and of its change when the nodes are doubled.
struct Probe {
    double square = 0, change_square = 0;
};

Probe compare(const std::vector<double>& coarse, const std::vector<double>& fine) {
    Probe probe;
    for (std::size_t k = 0; k < coarse.size(); ++k) {
        probe.square += fine[k] * fine[k];
        probe.change_square += (fine[k] - coarse[k]) * (fine[k] - coarse[k]);
    }
    return probe;
}

void check_planes(const Slab& planes, const ProjectOptions& options) {
    const auto require = [](bool is_right, const char* what, const char* expected) {
        if (!is_right) {
            throw Error("cannot project onto these planes", what, expected);
        }
    };
    require(planes.delta_m > 0.0, "delta_m", "> 0");
    require(planes.grid.x > 0 && planes.grid.y > 0 &&
                std::max(planes.grid.x, planes.grid.y) <= kMostFunctions,
            "grid", "1 x 1 ... 512 x 512");
    require(planes.texels.x > 0 && planes.texels.y > 0, "texels", "at least 1 x 1");
    require(planes.pitch_m.x > 0.0 && planes.pitch_m.y > 0.0, "pitch_m", "> 0");
    require(planes.s_max_m.x > planes.s_min_m.x && planes.s_max_m.y > planes.s_min_m.y, "s_max_m",
            "above s_min_m");
    require(planes.channels == 1 || planes.channels == 3, "channels", "1 or 3");
    const glm::dvec2 image_texels = glm::dvec2(planes.grid) * glm::dvec2(planes.texels);
    require(planes.channels * image_texels.x * image_texels.y <= kMostCoeffs, "grid and texels",
            "at most 2^30 coefficients");
    require(options.refine >= 1 && options.refine <= 8, "refine", "1 ... 8");
}

// What one row adds to the figures; summed in order afterwards, so that threads do not matter.
struct RowFigures {
    double flux = 0, negative = 0, rescaled = 0, integral = 0;
    Probe probe;
};

// Solves the row's channels and writes their coefficients into the slab.
void store_row(const Axis& axis_x,
               const Axis& axis_y,
               const RowData& data,
               int j,
               Slab& slab,
               RowFigures& figures) {
    const std::size_t width = static_cast<std::size_t>(slab.texels.x);
    const std::size_t block = static_cast<std::size_t>(slab.image_count()) * width;
    figures.flux = data.flux;
    for (int channel = 0; channel < slab.channels; ++channel) {
        const std::size_t c = static_cast<std::size_t>(channel);
        const std::span<const double> integral(&data.integral[c * width], width);
        const RowSolution solution =
            solve_row(axis_x, axis_y, {&data.b[c * block], block}, integral);
        const double weight = slab.channels == 1 ? 1.0 : kLuminanceRgb[c];
        figures.negative += weight * solution.negative_m2;
        figures.rescaled += weight * solution.rescaled_m2;
        figures.integral += weight * std::accumulate(integral.begin(), integral.end(), 0.0);
        for (int m = 0; m < slab.image_count(); ++m) {
            float* const target =
                &slab.coeffs[slab.image_offset(channel, m) + static_cast<std::size_t>(j) * width];
            const double* const origin = &solution.coeffs[static_cast<std::size_t>(m) * width];
            std::transform(origin, origin + width, target,
                           [](double value) { return static_cast<float>(value); });
        }
    }
}

ProjectFigures sum_figures(const std::vector<RowFigures>& rows) {
    ProjectFigures figures;
    RowFigures sum;
    for (const RowFigures& row : rows) {
        sum.flux += row.flux;
        sum.negative += row.negative;
        sum.rescaled += row.rescaled;
        sum.integral += row.integral;
        sum.probe.square += row.probe.square;
        sum.probe.change_square += row.probe.change_square;
    }
    figures.flux_lm = sum.flux;
    if (sum.integral > 0.0) {
        figures.negative_share = sum.negative / sum.integral;
        figures.rescaled_share = sum.rescaled / sum.integral;
    }
    if (sum.probe.square > 0.0) {
        figures.quadrature_error = std::sqrt(sum.probe.change_square / sum.probe.square);
    }
    return figures;
}

}  // namespace

Projection project(const Source& source, const Slab& planes, const ProjectOptions& options) {
    check_planes(planes, options);
    const double start_s = now_s();
    const Axis axis_x = make_axis(planes, 0), axis_y = make_axis(planes, 1);
    const Nodes nodes = make_nodes(source, planes, axis_x, axis_y, options.refine);
    const Nodes fine = make_nodes(source, planes, axis_x, axis_y, 2 * options.refine);
    Projection projection;
    projection.slab = planes;
    projection.slab.coeffs.assign(static_cast<std::size_t>(planes.channels) *
                                      static_cast<std::size_t>(planes.image_count()) *
                                      planes.texel_count(),
                                  0.0F);
    std::vector<RowFigures> figures(static_cast<std::size_t>(planes.texels.y));
    const int probe_step = std::min(kProbeStep, planes.texels.y);
    std::mutex progress_mutex;
    int done = 0;
    tbb::parallel_for(0, planes.texels.y, [&](int j) {
        RowFigures& row_figures = figures[static_cast<std::size_t>(j)];
        const RowData data = RowIntegrator(source, planes, nodes).integrate(j);
        if (j % probe_step == probe_step / 2) {
            row_figures.probe = compare(data.b, RowIntegrator(source, planes, fine).integrate(j).b);
        }
        store_row(axis_x, axis_y, data, j, projection.slab, row_figures);
        const std::lock_guard lock(progress_mutex);
        ++done;
        if (options.progress) {
            options.progress(static_cast<double>(done) / planes.texels.y);
        }
    });
    projection.figures = sum_figures(figures);
    projection.figures.time_s = now_s() - start_s;
    return projection;
}

}  // namespace nearfield::sample_data
