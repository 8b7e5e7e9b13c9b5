// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/directions.h"

#include "formats/model/profile.h"
#include "formats/rays/texel_flux.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nearfield::rays {
namespace {

constexpr int kNoFold = -1;

// Pitches across U's larger side that are tried, in cells.
constexpr std::array kCellsAcross = {3, 4, 6, 8, 11, 13, 15, 20, 28, 40};
// The pitch at which blocks are chosen first, before others are tried with the same blocks.
constexpr int kFirstCells = 8;
constexpr std::array kGlobalIterations = {1, 2, 4, 8, 16, 32};
// Finer levels start from the larger block's shares and are held by them: a few steps suffice.
constexpr int kLevelIterations = 5;
constexpr std::array kPriorRays = {16.0, 64.0, 256.0};
// Subdivisions that are tried at every level. Halves alone would stop at a wedge of light whose
// halves look alike.
const std::array kSplits = {glm::ivec2(2, 1), glm::ivec2(4, 1), glm::ivec2(8, 1),
                            glm::ivec2(1, 2), glm::ivec2(1, 4), glm::ivec2(1, 8)};
// Two of the four folds are enough to tell levels apart, at half the time.
constexpr std::size_t kDirectionFolds = 2;
constexpr int kMostBlocksAcross = 64;
// A subdivision must gain this many nats per ray: less is within the noise of cross-validation.
constexpr double kLeastGain = 2e-4;

// Every ray's basis functions: the first one's column and row, and n values along x and along y.
struct Footprints {
    int n = 1;
    std::vector<glm::ivec2> first;
    std::vector<float> values;  // [ray][2][n]
};

Footprints make_footprints(const std::vector<Crossing>& crossings, const Aperture& aperture) {
    Footprints f;
    f.n = static_cast<int>(aperture.profile.cells.size());
    const auto n = static_cast<std::size_t>(f.n);
    f.first.resize(crossings.size());
    f.values.resize(crossings.size() * 2 * n);
    tbb::parallel_for(std::size_t{0}, crossings.size(), [&](std::size_t r) {
        // Position in pitches from the first basis function's center.
        const glm::dvec2 x = (glm::dvec2(crossings[r].u_m) - aperture.center_m) / aperture.pitch_m +
                             0.5 * glm::dvec2(aperture.grid - 1);
        for (int axis = 0; axis < 2; ++axis) {
            const int first = static_cast<int>(std::floor(x[axis] - 0.5 * f.n)) + 1;
            f.first[r][axis] = first;
            for (int k = 0; k < f.n; ++k)
                f.values[(2 * r + static_cast<std::size_t>(axis)) * n +
                         static_cast<std::size_t>(k)] =
                    static_cast<float>(model::eval(aperture.profile, x[axis] - (first + k)));
        }
    });
    return f;
}

// Calls visit(m, Phi_m(u)) for the basis functions over ray r's u.
template <typename Visit>
void for_each_basis(const Footprints& f, std::size_t r, glm::ivec2 grid, const Visit& visit) {
    const auto n = static_cast<std::size_t>(f.n);
    const float* x = &f.values[2 * r * n];
    const float* y = x + n;
    for (int j = 0; j < f.n; ++j) {
        const int row = f.first[r].y + j;
        if (row < 0 || row >= grid.y)
            continue;
        for (int i = 0; i < f.n; ++i) {
            const int column = f.first[r].x + i;
            if (column >= 0 && column < grid.x)
                visit(static_cast<std::size_t>(row * grid.x + column), x[i] * y[j]);
        }
    }
}

// What all fits of one slab and one grid share.
struct Problem {
    const std::vector<Crossing>& crossings;
    Rectangle s;
    Aperture aperture;
    const std::vector<glm::vec3>* colors = nullptr;  // one a ray of the RaySet, or null
    std::vector<std::uint8_t> fold;                  // empty: no cross-validation
    Footprints footprints;
    double ray_flux = 0;  // flux-weighted mean flux of a ray: what one ray of prior weighs

    int channels() const { return colors == nullptr ? 1 : 4; }
};

Problem make_problem(const std::vector<Crossing>& crossings,
                     const Rectangle& s,
                     const Aperture& aperture) {
    Problem p{crossings, s, aperture, nullptr, {}, make_footprints(crossings, aperture), 0.0};
    double sum = 0.0, squares = 0.0;
    for (const Crossing& c : crossings) {
        sum += c.flux;
        squares += static_cast<double>(c.flux) * c.flux;
    }
    p.ray_flux = sum > 0.0 ? squares / sum : 0.0;
    return p;
}

// Rays sorted by block: order[begin[b] ... begin[b + 1]).
struct Blocks {
    std::vector<std::uint32_t> order;
    std::vector<std::size_t> begin;
};

Blocks sort_by_block(const Problem& p, glm::ivec2 blocks) {
    const TexelGrid grid{p.s, blocks};
    Blocks sorted;
    sorted.begin.assign(grid.count() + 1, 0);
    std::vector<std::uint32_t> block(p.crossings.size());
    for (std::size_t r = 0; r < block.size(); ++r) {
        block[r] = static_cast<std::uint32_t>(grid.index(p.crossings[r].s_m));
        ++sorted.begin[block[r] + 1];
    }
    for (std::size_t b = 1; b < sorted.begin.size(); ++b)
        sorted.begin[b] += sorted.begin[b - 1];
    std::vector<std::size_t> next(sorted.begin.begin(), sorted.begin.end() - 1);
    sorted.order.resize(block.size());
    for (std::size_t r = 0; r < block.size(); ++r)
        sorted.order[next[block[r]]++] = static_cast<std::uint32_t>(r);
    return sorted;
}

// The parent's shares at a place, per unit of flux: [channel][m].
std::vector<double> shares_at(const BlockShares& parent, glm::dvec2 s_m) {
    const BlockWeights at = weights_at(parent.blocks, parent.s, s_m);
    std::vector<double> shares(static_cast<std::size_t>(parent.channels * parent.images));
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
        sum += at.weight[k] * parent.block_flux[at.block[k]];
        for (std::size_t i = 0; i < shares.size(); ++i)
            shares[i] += at.weight[k] * parent.flux[parent.offset(at.block[k], 0) + i];
    }
    for (double& share : shares)
        share = sum > 0.0 ? share / sum : 0.0;
    return shares;
}

// One step: shares the flux of a block's rays out by the present shares. Returns [channel][m].
std::vector<double> share_out(const Problem& p,
                              const std::uint32_t* rays,
                              std::size_t count,
                              int skip_fold,
                              const std::vector<double>& present) {
    const auto images = static_cast<std::size_t>(p.aperture.image_count());
    std::vector<double> next(present.size());
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t r = rays[i];
        if (skip_fold != kNoFold && p.fold[r] == skip_fold)
            continue;
        double sum = 0.0, basis_sum = 0.0;
        for_each_basis(p.footprints, r, p.aperture.grid, [&](std::size_t m, float phi) {
            sum += present[m] * phi;
            basis_sum += phi;
        });
        const Crossing& c = p.crossings[r];
        // Where the present shares are dark (no ray of the larger block was here), Phi alone
        // decides.
        const bool dark = !(sum > 0.0);
        const double scale = c.flux / (dark ? basis_sum : sum);
        if (!std::isfinite(scale))
            continue;
        for_each_basis(p.footprints, r, p.aperture.grid, [&](std::size_t m, float phi) {
            const double part = scale * phi * (dark ? 1.0 : present[m]);
            next[m] += part;
            for (std::size_t k = 1; k * images < next.size(); ++k)
                next[k * images + m] += part * (*p.colors)[c.ray][static_cast<int>(k) - 1];
        });
    }
    return next;
}

// The shares of one block's rays, [channel][m], drawn to `prior` (empty: to nothing).
std::vector<double> fit_block(const Problem& p,
                              const std::uint32_t* rays,
                              std::size_t count,
                              const Level& level,
                              const std::vector<double>& prior,
                              int skip_fold) {
    const auto images = static_cast<std::size_t>(p.aperture.image_count());
    const std::size_t size = static_cast<std::size_t>(p.channels()) * images;
    const double prior_flux = level.prior_rays * p.ray_flux;
    std::vector<double> present = prior;
    if (prior.empty())
        present.assign(size, 1.0 / static_cast<double>(images));
    for (int step = 0; step < level.iterations; ++step) {
        present = share_out(p, rays, count, skip_fold, present);
        double sum = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
            present[i] += prior.empty() ? 0.0 : prior_flux * prior[i];
            sum += i < images ? present[i] : 0.0;
        }
        for (double& share : present)
            share = sum > 0.0 ? share / sum : 0.0;
    }
    return present;
}

BlockShares fit_level(const Problem& p,
                      const Blocks& sorted,
                      const Level& level,
                      const BlockShares* parent,
                      int skip_fold) {
    BlockShares fit{level.blocks, p.aperture.image_count(), p.channels(), {}, {}, p.s};
    const TexelGrid grid{p.s, level.blocks};
    const auto size = static_cast<std::size_t>(fit.channels * fit.images);
    fit.flux.resize(grid.count() * size);
    fit.block_flux.resize(grid.count());
    tbb::parallel_for(std::size_t{0}, grid.count(), [&](std::size_t b) {
        const std::uint32_t* rays = sorted.order.data() + sorted.begin[b];
        const std::size_t count = sorted.begin[b + 1] - sorted.begin[b];
        double flux = 0.0;
        for (std::size_t i = 0; i < count; ++i)
            if (skip_fold == kNoFold || p.fold[rays[i]] != skip_fold)
                flux += p.crossings[rays[i]].flux;
        if (!(flux > 0.0))
            return;
        const auto columns = static_cast<std::size_t>(level.blocks.x);
        const std::size_t column = b % columns, row = b / columns;
        const glm::dvec2 block(static_cast<double>(column), static_cast<double>(row));
        const std::vector<double> prior =
            parent != nullptr ? shares_at(*parent, p.s.min_m + (block + 0.5) * grid.size_m())
                              : std::vector<double>();
        const std::vector<double> present = fit_block(p, rays, count, level, prior, skip_fold);
        for (std::size_t i = 0; i < size; ++i)
            fit.flux[b * size + i] = static_cast<float>(present[i] * flux);
        fit.block_flux[b] = flux;
    });
    return fit;
}

// Sum of flux times log density on U of the rays of one fold, and their flux.
struct Score {
    double nats = 0, flux = 0;
};

Score score(const Problem& p, const BlockShares& fit, int fold) {
    const glm::dvec2 cells(p.aperture.grid - static_cast<int>(p.aperture.profile.cells.size()) + 1);
    const double area_m2 =
        cells.x * cells.y * p.aperture.pitch_m.x * p.aperture.pitch_m.y;  // where it sums to one
    const double scale = area_m2 / p.aperture.integral_m2();
    Score result;
    for (std::size_t r = 0; r < p.crossings.size(); ++r) {
        if (p.fold[r] != fold)
            continue;
        const BlockWeights at = weights_at(fit.blocks, fit.s, p.crossings[r].s_m);
        double flux = 0.0, density = 0.0;
        for (int k = 0; k < 4; ++k)
            flux += at.weight[k] * fit.block_flux[at.block[k]];
        for_each_basis(p.footprints, r, p.aperture.grid, [&](std::size_t m, float phi) {
            for (int k = 0; k < 4; ++k)
                density += at.weight[k] * fit.flux[fit.offset(at.block[k], 0) + m] * phi;
        });
        density = flux > 0.0 ? density * scale / flux : 0.0;
        result.nats += p.crossings[r].flux * std::log((1.0 - kFloor) * density + kFloor);
        result.flux += p.crossings[r].flux;
    }
    return result;
}

// The fits of every fold's complement at one level.
struct FoldFits {
    std::vector<BlockShares> fits;
    double nats = -std::numeric_limits<double>::infinity();
};

FoldFits fit_folds(const Problem& p, const Level& level, const FoldFits* parent) {
    const Blocks sorted = sort_by_block(p, level.blocks);
    FoldFits result;
    result.fits.resize(kDirectionFolds);
    std::array<Score, kDirectionFolds> scores;
    tbb::parallel_for(std::size_t{0}, kDirectionFolds, [&](std::size_t f) {
        result.fits[f] = fit_level(p, sorted, level, parent != nullptr ? &parent->fits[f] : nullptr,
                                   static_cast<int>(f));
        scores[f] = score(p, result.fits[f], static_cast<int>(f));
    });
    Score sum;
    for (const Score& s : scores) {
        sum.nats += s.nats;
        sum.flux += s.flux;
    }
    result.nats = sum.flux > 0.0 ? sum.nats / sum.flux : 0.0;
    return result;
}

// Subdivides S, along x or y, for as long as held-out rays are predicted better.
DirectionChoice choose_levels(const Problem& p) {
    DirectionChoice choice{p.aperture.grid, {}, 0.0};
    FoldFits current;
    // The fewest iterations that are as good as the best: more of them sharpen noise.
    std::vector<std::pair<Level, FoldFits>> tried;
    double most = current.nats;
    for (const int iterations : kGlobalIterations) {
        const Level level{glm::ivec2(1), 0.0, iterations};
        tried.emplace_back(level, fit_folds(p, level, nullptr));
        most = std::max(most, tried.back().second.nats);
    }
    for (auto& [level, fit] : tried)
        if (fit.nats >= most - negligible_nats(p.crossings.size())) {
            current = std::move(fit);
            choice.levels = {level};
            break;
        }
    for (;;) {
        FoldFits best;
        Level best_level;
        for (const glm::ivec2 split : kSplits)
            for (const double prior_rays : kPriorRays) {
                const Level level{choice.levels.back().blocks * split, prior_rays,
                                  kLevelIterations};
                if (std::max(level.blocks.x, level.blocks.y) > kMostBlocksAcross)
                    continue;
                FoldFits fit = fit_folds(p, level, &current);
                if (fit.nats > best.nats) {
                    best = std::move(fit);
                    best_level = level;
                }
            }
        if (!(best.nats > current.nats + kLeastGain))
            break;
        current = std::move(best);
        choice.levels.push_back(best_level);
    }
    choice.held_out_nats = current.nats;
    return choice;
}

double replay(const Problem& p, const std::vector<Level>& levels) {
    FoldFits current;
    for (std::size_t l = 0; l < levels.size(); ++l)
        current = fit_folds(p, levels[l], l > 0 ? &current : nullptr);
    return current.nats;
}

}  // namespace

DirectionChoice choose_directions(const std::vector<Crossing>& crossings,
                                  const Rectangle& s,
                                  const Rectangle& u,
                                  const Profile& profile,
                                  std::optional<glm::ivec2> grid,
                                  std::uint64_t seed) {
    std::vector<std::uint8_t> fold(crossings.size());
    for (std::size_t r = 0; r < fold.size(); ++r)
        fold[r] = static_cast<std::uint8_t>(fold_of(crossings[r].ray, seed));
    const auto problem = [&](glm::ivec2 size) {
        Problem p = make_problem(crossings, s, cover(profile, u, size));
        p.fold = fold;
        return p;
    };
    if (grid)
        return choose_levels(problem(*grid));
    const std::vector<Level> levels =
        choose_levels(problem(square_grid(profile, u, kFirstCells))).levels;
    std::vector<std::pair<glm::ivec2, double>> tried;
    double best = -std::numeric_limits<double>::infinity();
    for (const int cells : kCellsAcross) {
        const glm::ivec2 size = square_grid(profile, u, cells);
        const double nats = replay(problem(size), levels);
        tried.emplace_back(size, nats);
        best = std::max(best, nats);
        if (nats < best - 10.0 * negligible_nats(crossings.size()))
            break;  // far beyond the best: finer ones only get worse
    }
    const auto chosen = std::find_if(tried.begin(), tried.end(), [&](const auto& t) {
        return t.second >= best - negligible_nats(crossings.size());
    });
    return choose_levels(problem(chosen->first));
}

std::vector<BlockShares> fit_directions(const std::vector<Crossing>& crossings,
                                        const Rectangle& s,
                                        const Aperture& aperture,
                                        const std::vector<Level>& levels,
                                        const std::vector<glm::vec3>& colors) {
    Problem p = make_problem(crossings, s, aperture);
    p.colors = colors.size() > 1 ? &colors : nullptr;
    std::vector<BlockShares> fits;
    for (std::size_t l = 0; l < levels.size(); ++l)
        fits.push_back(fit_level(p, sort_by_block(p, levels[l].blocks), levels[l],
                                 l > 0 ? &fits[l - 1] : nullptr, kNoFold));
    return fits;
}

}  // namespace nearfield::rays
