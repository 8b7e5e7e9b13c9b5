// SPDX-License-Identifier: Apache-2.0
#include "fit/stream.h"

#include "fit/keep_light.h"
#include "formats/files/error.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::fit {
namespace {

// What a thread works with.
struct Scratch {
    TexelDesign texel;
    Workspace work;
    TexelData data;
    std::vector<TexelFit> fit;  // [channel]: where the next texel starts
};

struct TileJob {
    const Design& design;
    const FitOptions& options;
    const Penalty& penalty;
    TileRange rows;
    TileLayout layout;
    const TileInput& input;
    TileResult& result;
};

void store(const TileJob& job,
           std::size_t channel,
           std::size_t row,
           std::size_t i,
           const std::vector<double>& values,
           std::vector<float>& images) {
    for (std::size_t m = 0; m < job.layout.functions; ++m)
        images[job.layout.at(channel, m, job.layout.functions, row, i)] =
            static_cast<float>(values[m]);
}

void add_texel(const TexelFit& fit, double kkt_limit, FitReport& report) {
    ++report.texel_count;
    report.unconverged_count += fit.kkt_rel <= kkt_limit ? 0 : 1;
    report.unseen_count += fit.valid_count == 0 ? 1 : 0;
    report.valid_count += fit.valid_count;
    report.free_count += fit.free_count;
    report.factorizations += fit.factorizations;
    report.kkt_worst = std::max(report.kkt_worst, fit.kkt_rel);
    const double decade = fit.kkt_rel > 0.0 ? -std::log10(fit.kkt_rel) : 1e9;
    const double last = static_cast<double>(report.kkt_decades.size()) - 1.0;
    ++report.kkt_decades[static_cast<std::size_t>(std::clamp(std::floor(decade), 0.0, last))];
    report.chi_square += fit.chi_square;
}

void fit_texel(const TileJob& job, Scratch& s, TexelFit& fit) {
    solve_texel(s.texel, job.penalty, s.data.b, s.data.weight, job.options.solve, s.work, fit,
                s.data.noise_share);
    if (job.options.keeps_light)
        keep_light(s.data.b, s.data.weight, s.work, fit);
}

// The texels of a row from left to right: each starts from its neighbor's free coefficients, the
// first from all free, so that nothing depends on tiles or threads.
FitReport solve_row(const TileJob& job, std::size_t row, Scratch& s) {
    FitReport report;
    s.fit.assign(job.layout.channels, {});
    for (std::size_t i = 0; i < job.layout.width; ++i) {
        if (i == 0 || job.design.is_varying())
            fill_texel_design(job.design, static_cast<int>(i),
                              job.rows.first_row + static_cast<int>(row), s.texel);
        for (std::size_t c = 0; c < job.layout.channels; ++c) {
            TexelFit& fit = s.fit[c];
            read_texel(job.input, job.layout, c, row, i, job.options.model_error_rel, s.data);
            fit_texel(job, s, fit);
            store(job, c, row, i, fit.coeffs, job.result.coeffs);
            if (job.options.solve.wants_sigma)
                store(job, c, row, i, fit.sigma, job.result.sigma);
            const std::size_t at = job.layout.texel(c, row, i);
            job.result.chi_square[at] = static_cast<float>(fit.chi_square);
            job.result.kkt_rel[at] = static_cast<float>(fit.kkt_rel);
            job.result.valid_count[at] = static_cast<std::int16_t>(fit.valid_count);
            job.result.free_count[at] = static_cast<std::int16_t>(fit.free_count);
            add_texel(fit, job.options.kkt_limit, report);
        }
    }
    return report;
}

TileResult empty_result(const TileLayout& layout, const FitOptions& options, TileRange rows) {
    const std::size_t texels = layout.channels * layout.rows * layout.width;
    TileResult result;
    result.rows = rows;
    result.coeffs.resize(texels * layout.functions);
    if (options.solve.wants_sigma)
        result.sigma.resize(texels * layout.functions);
    result.chi_square.resize(texels);
    result.kkt_rel.resize(texels);
    result.valid_count.resize(texels);
    result.free_count.resize(texels);
    return result;
}

}  // namespace

double FitReport::reduced_chi_square() const {
    const auto degrees = static_cast<double>(valid_count - free_count);
    return degrees > 0.0 ? chi_square / degrees : 0.0;
}

double FitReport::kkt_quantile(double share) const {
    const double wanted = share * static_cast<double>(texel_count);
    double count = 0.0;
    for (std::size_t d = kkt_decades.size(); d-- > 0;) {
        count += static_cast<double>(kkt_decades[d]);
        if (count >= wanted)
            return std::pow(10.0, -static_cast<double>(d));
    }
    return 1.0;
}

FitReport merged(const FitReport& a, const FitReport& b) {
    FitReport sum = a;
    sum.texel_count += b.texel_count;
    sum.unconverged_count += b.unconverged_count;
    sum.unseen_count += b.unseen_count;
    sum.valid_count += b.valid_count;
    sum.free_count += b.free_count;
    sum.factorizations += b.factorizations;
    sum.kkt_worst = std::max(a.kkt_worst, b.kkt_worst);
    for (std::size_t d = 0; d < sum.kkt_decades.size(); ++d)
        sum.kkt_decades[d] += b.kkt_decades[d];
    sum.chi_square += b.chi_square;
    return sum;
}

void check(const FitOptions& options) {
    const auto refuse = [](const char* field, const char* expected, double got) {
        throw Error{"bad option", field, expected, fmt::format("{}", got)};
    };
    if (!(options.solve.lambda >= 0.0) || std::isinf(options.solve.lambda))
        refuse("lambda", "finite, >= 0", options.solve.lambda);
    if (options.solve.difference_order != 1 && options.solve.difference_order != 2)
        refuse("difference_order", "1 or 2", options.solve.difference_order);
    if (options.channels < 1)
        refuse("channels", ">= 1", options.channels);
    if (!(options.model_error_rel >= 0.0) || std::isinf(options.model_error_rel))
        refuse("model_error_rel", "finite, >= 0", options.model_error_rel);
    if (!(options.tile_bytes > 0.0))
        refuse("tile_bytes", "> 0", options.tile_bytes);
}

int tile_rows(const Design& design, const FitOptions& options) {
    const double images = options.solve.wants_sigma ? 2.0 : 1.0;
    const double row_bytes = sizeof(float) * static_cast<double>(options.channels) *
                             design.texels.x *
                             (2.0 * design.measurement_count + images * design.basis_count() + 3.0);
    return static_cast<int>(
        std::clamp(options.tile_bytes / row_bytes, 1.0, static_cast<double>(design.texels.y)));
}

TileResult solve_tile(const Design& design,
                      const FitOptions& options,
                      TileRange rows,
                      const TileInput& input,
                      FitReport& report) {
    check(options);
    const TileLayout layout = tile_layout(design, options.channels, rows);
    const std::size_t wanted = layout.channels * layout.measurements * layout.rows * layout.width;
    if (input.value.size() != wanted || input.variance.size() != wanted)
        throw Error{"bad tile", fmt::format("rows from {}", rows.first_row),
                    fmt::format("{} values", wanted), fmt::format("{}", input.value.size())};
    TileResult result = empty_result(layout, options, rows);
    const Penalty penalty = difference_penalty(design.grid, options.solve.difference_order);
    const TileJob job{design, options, penalty, rows, layout, input, result};
    std::vector<FitReport> row_reports(layout.rows);
    tbb::enumerable_thread_specific<Scratch> scratch;
    tbb::parallel_for(std::size_t{0}, layout.rows, [&](std::size_t row) {
        row_reports[row] = solve_row(job, row, scratch.local());
    });
    for (const FitReport& row : row_reports)
        report = merged(report, row);
    return result;
}

FitReport solve_lightfield(const Design& design,
                           const FitOptions& options,
                           const ReadTile& read,
                           const WriteTile& write,
                           const std::function<void(double fraction)>& progress) {
    check(options);
    FitReport report;
    const int step = tile_rows(design, options);
    for (int first = 0; first < design.texels.y; first += step) {
        const TileRange rows{first, std::min(step, design.texels.y - first)};
        write(solve_tile(design, options, rows, read(rows), report));
        if (progress)
            progress(static_cast<double>(rows.first_row + rows.row_count) / design.texels.y);
    }
    return report;
}

}  // namespace nearfield::fit
