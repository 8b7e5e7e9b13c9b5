// SPDX-License-Identifier: Apache-2.0
/// Samplers of a lamp's light, by name: points on U drawn for one receiver, each with the light
/// that it carries.
///
/// Energies A_m = int over Phi_m's support of C_m(s(u)) du are kept per unit of (delta + Delta)^2
/// and times delta^2 (irradiance weighting), so that they are illuminances, comparable between
/// slabs, and nothing special happens at Delta = 0. In luminance; color comes with each sample.
///
/// Source  Lu, Pacanowski, Granier, "Position-dependent importance sampling of light field
///         luminaires", 2015 (Uniform: fig. 12; Precomputed; Pdis: eq. (8) to (12) as printed).
///         Systematic and Cells: unbiased for every K >= 1 with random shifts (ARCHITECTURE.md).
#pragma once

#include "formats/files/luminaire.h"
#include "formats/model/axis_window.h"
#include "formats/model/prepared.h"
#include "formats/shared/restricted.glsl.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace nearfield::model {

enum class Sampler {
    Uniform,      // equal counts per image, uniform in its box: a baseline
    Precomputed,  // whole images' CDFs, without regard to the receiver: a baseline
    Pdis,         // as printed, with its bias and its lost light: a baseline
    // One stratified coordinate across all images chooses the image; points of the plane,
    // stratified across images too, the place in it by the joint restricted density.
    Systematic,
    // One stratified coordinate across all (image, cell of U) pairs, by energy times Phi's mean
    // over the cell; what it leaves of a pair is the place along x.
    Cells,
};

enum class Sequence { Halton, R2, Fibonacci, Sobol };

/// Where the random shift of a receiver's points comes from.
enum class Shift {
    Constant,   // 0 everywhere: structured error instead of noise, biased
    Random,     // a hash of pixel, pass and seed
    BlueNoise,  // a 64 x 64 tile of blue noise (void and cluster), moved on by R2 from pass to pass
    Interleaved,  // 4 x 4 pixels share one shift each place (Keller and Heidrich 2001)
};

/// How Pdis inverts its CDFs (the others always bisect over integer indices, to the end).
enum class Search { Bisection, Secant };

/// Where corners of summed-area tables come from. Pair is what files hold and renderers use; the
/// others exist to be measured.
enum class TablePrecision { Float, Pair };

struct SamplerOptions {
    Sampler sampler = Sampler::Systematic;
    int samples = 64;  // K, of a receiver and lamp, >= 1. Pdis and Uniform draw about as many
    Sequence sequence = Sequence::R2;
    int k_max = 0;                      // Pdis: most samples of one image; 0: no limit
    Search search = Search::Bisection;  // Pdis
    int search_steps = 0;               // Pdis: cut short after so many; 0: to the end
    TablePrecision precision = TablePrecision::Pair;
};

/// Names on the command line and in reports: "uniform", "precomputed", "pdis", "systematic",
/// "cells"; "halton", "r2", "fibonacci", "sobol"; "constant", "random", "blue-noise",
/// "interleaved".
std::string name_of(Sampler sampler);
std::string name_of(Sequence sequence);
std::string name_of(Shift shift);

/// The sequence that a sampler is published with: Halton for Uniform, Precomputed and Pdis, else
/// R2.
Sequence default_sequence(Sampler sampler);

/// A lamp's slab with what samplers read. Immutable, shared by all threads.
struct SamplingSlab {
    PreparedSlab prepared;
    SlabTables tables;
};

/// Takes the slab over and builds its tables unless given.
SamplingSlab prepare_sampling(Slab slab);
SamplingSlab prepare_sampling(Slab slab, SlabTables tables);

/// One receiver's view of one slab; reused from receiver to receiver for its memory.
struct SamplingView {
    ReceiverF receiver;
    shared::AxisView x_view{}, y_view{};
    shared::AxisTexels x_texels{}, y_texels{};
    /// What each basis function's support shows along x [column] and y [row]; Cells: each cell of
    /// U, [W + n - 1] and [H + n - 1].
    std::vector<shared::AxisBox> x, y;
    /// What is drawn from: [image]; Cells: [image][cell along y][cell along x]. Uniform: 1 for
    /// every image that sends light; Precomputed: images' totals.
    std::vector<float> energy;
    float total = 0.0F;       // sum of `energy`
    float drawn = 0.0F;       // Pdis and Uniform: samples of the whole lamp, set by draw()
    std::uint64_t reads = 0;  // floats read from tables and texels, counted until reset by the user
    std::vector<float> columns;  // a dark window's, while samples are drawn from it
};

/// Fills the view. total = 0 where the receiver sees no light (behind U, facing away, dark).
/// Cost    16 table corners an image; Cells: (2n + 2)^2.
void look(const SamplingSlab& slab,
          const ReceiverF& receiver,
          const SamplerOptions& options,
          SamplingView& view);

/// A point on U and its light.
struct LightSample {
    glm::vec2 u_m{0.0F};
    int slab = 0;   // index in the lamp
    int image = 0;  // from which it was drawn
    /// The sum of light * V(u) over all samples of a receiver estimates its shadowed irradiance, R
    /// G B (Y three times for one channel); of radiance_factor * f_r * V its reflected radiance.
    glm::vec3 light{0.0F};
};

/// Draws the samples of one lamp: views[k] is of slabs[k]. shift: uniform in [0, 1)^2 (xi_0, xi_1).
/// `samples` is filled anew; those that send no light (dark, outside Phi_m, behind the receiver)
/// are left out. Sequences that need more dimensions hash the shift.
void draw(std::span<const SamplingSlab> slabs,
          std::span<SamplingView> views,
          const SamplerOptions& options,
          glm::vec2 shift,
          std::vector<LightSample>& samples);

/// Density of the samples, for combining with other ways to draw directions.
/// joint: of (image m, u), per m^2 on U; its sum over m is the marginal: of u whatever the image.
/// Both are of one sample among K, of the lamp whose views' totals sum to lamp_total. Call draw()
/// before: Pdis' density depends on all counts of the lamp.
float joint_density_u(const SamplingSlab& slab,
                      const SamplingView& view,
                      const SamplerOptions& options,
                      float lamp_total,
                      int image,
                      glm::vec2 u_m);
float marginal_density_u(const SamplingSlab& slab,
                         const SamplingView& view,
                         const SamplerOptions& options,
                         float lamp_total,
                         glm::vec2 u_m);
/// The same per solid angle from the receiver: p_u R^3 / (delta + Delta).
float marginal_density_omega(const SamplingSlab& slab,
                             const SamplingView& view,
                             const SamplerOptions& options,
                             float lamp_total,
                             glm::vec2 u_m);

/// The inverse of sampling within an image (Cells: within a cell): the coordinates in [0, 1)^2 that
/// give u. 0 where the sampler draws nothing there.
glm::vec2 inverse_u(const SamplingSlab& slab,
                    const SamplingView& view,
                    const SamplerOptions& options,
                    int image,
                    glm::vec2 u_m);

/// L(u -> p) of the slab, from a point u on U towards p = receiver: for directions drawn by a BRDF.
/// 0 where the ray misses S or U. Cost: n^2 texels a channel.
glm::vec3 radiance_towards(const PreparedSlab& slab, glm::vec3 p_m, glm::vec2 u_m);

/// Unshadowed irradiance of a lamp by one set of samples: what bench and probe evaluate. Receivers
/// are in each slab's frame.
glm::vec3 irradiance_by_sampler(std::span<const SamplingSlab> slabs,
                                std::span<const ReceiverF> receiver_in_slab,
                                const SamplerOptions& options,
                                glm::vec2 shift,
                                std::span<SamplingView> views,
                                std::vector<LightSample>& samples);

/// The shift of a pixel (or of a receiver's index, with y = 0) in a pass.
glm::vec2 shift_of(Shift shift, glm::uvec2 pixel, std::uint32_t pass, std::uint32_t seed);

}  // namespace nearfield::model
