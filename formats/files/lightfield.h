// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/provenance.h"

#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace nearfield {

/// Transforms point x from frame b to frame a: x_a = rotation * x_b + translation_m. Rotation is
/// proper (det +1).
struct Rigid {
    glm::dmat3 rotation{1.0};
    glm::dvec3 translation_m{0.0};
};

/// A 1-D basis function phi(x), a polynomial of degree <= 2 on each of n unit cells, zero outside.
///
/// x is in units of the grid's pitch, measured from the function's center; cell c spans
/// x in [c - n/2, c + 1 - n/2]. On it phi(x) = a0 + a1 x + a2 x^2 with cells[c] = {a0, a1, a2}.
struct Profile {
    std::string name;  // "box", "bilinear", "quadratic", "bspline" or "measured"
    std::vector<std::array<double, 3>> cells;
};

/// What multiplies sum_m C_m(s) Phi_m(u) to give radiance (Goesele et al. 2003; lumigraph).
enum class Weighting {
    Irradiance,  // delta^2 / cos^4(theta); C_m in W m^-4 (lm m^-4)
    Radiance,    // 1;                      C_m in W m^-2 sr^-1 (cd m^-2)
};

enum class Quantity {
    Photometric,  // lm, lx, cd
    Radiometric,  // W, W m^-2, W sr^-1
};

/// One pair of parallel planes and the light that crosses them, in the slab's frame (metres,
/// right-handed): image plane S at z = 0, basis plane U at z = -delta_m, light travels towards +z.
///
/// L(u -> s) = weight * sum_m C_m(s) Phi_m(u). C_m is piecewise constant on texels of S's rectangle
/// and zero outside; Phi_m(u) = phi((u.x - center_m.x)/pitch.x) * phi((u.y - center_m.y)/pitch.y).
struct Slab {
    Rigid luminaire_from_slab;
    double delta_m = 0;                 // distance of the planes, > 0
    glm::ivec2 grid{0};                 // W, H: basis functions along x and y
    glm::dvec2 pitch_m{0};              // distance of neighboring basis centers
    glm::dvec2 u_center_m{0};           // center of the grid on U
    glm::ivec2 texels{0};               // w, h: texels of every image along x and y
    glm::dvec2 s_min_m{0}, s_max_m{0};  // S's rectangle
    Profile profile;
    Weighting weighting = Weighting::Irradiance;
    int channels = 1;  // 1: Y; 3: linear Rec.709 R G B, Y = 0.2126 R + 0.7152 G + 0.0722 B
    /// [channel][m][j][i]: image m = row * W + column; i rises with x, j and row with y.
    std::vector<float> coeffs;
    /// Standard deviation of each coefficient, same shape; empty: unknown. Texels and images are
    /// independent; a texel's channels rise and fall together (they come from the same rays or
    /// light), so that a color's sigmas add without quadrature.
    std::vector<float> sigma;
    /// What fits of other noise and another calibration gave, each like coeffs; empty: none. The
    /// spread of what is computed from them is its sigma, with all that texels share.
    std::vector<std::vector<float>> replicates;

    int image_count() const { return grid.x * grid.y; }
    std::size_t texel_count() const {
        return static_cast<std::size_t>(texels.x) * static_cast<std::size_t>(texels.y);
    }
    glm::dvec2 texel_m() const { return (s_max_m - s_min_m) / glm::dvec2(texels); }
    /// Center of basis function (column, row) on U.
    glm::dvec2 basis_center_m(int column, int row) const {
        return u_center_m + (glm::dvec2(column, row) - 0.5 * glm::dvec2(grid - 1)) * pitch_m;
    }
    /// Offset in coeffs and sigma of image m in a channel.
    std::size_t image_offset(int channel, int m) const {
        return (static_cast<std::size_t>(channel) * static_cast<std::size_t>(image_count()) +
                static_cast<std::size_t>(m)) *
               texel_count();
    }
};

/// A lamp: one slab or more whose light adds, in the luminaire's frame. The first slab's S lies at
/// z = 0 of it.
struct LightField {
    Quantity quantity = Quantity::Photometric;
    std::vector<Slab> slabs;
    double scale_sigma_rel = 0;  // one sigma of a factor common to all coefficients
    Provenance provenance;
};

/// Luminance (or radiometric total) weights of R, G, B: Rec.709.
constexpr std::array<double, 3> kLuminanceRgb = {0.2126, 0.7152, 0.0722};

/// Throws Error naming `where`, slab and field if a LightField breaks any rule above: sizes, finite
/// numbers, C_m >= 0, proper rotation.
void check(const LightField& lightfield, const std::string& where);

/// Writes NAME.lightfield.exr (docs/formats.md). The file appears whole under its name or not at
/// all. `run` is left out where the caller wants reproducible bytes.
void write_lightfield(const LightField& lightfield,
                      const std::optional<RunRecord>& run,
                      const std::string& path);

/// The newest version of the file format; this program writes it and reads it and all before.
constexpr int kFormatVersion = 1;

/// What a file of ours says it is.
struct FileKind {
    std::string kind;  // "lightfield" or "luminaire"
    int format_version = 0;
};

/// Whether an EXR file is a light field or luminaire, rather than a picture. Throws Error if it is
/// no EXR file.
bool holds_luminaire(const std::string& path);

/// Reads a file's kind alone. Throws Error where it is neither kind, or of a newer version than
/// kFormatVersion.
FileKind read_kind(const std::string& path);

/// Reads a light field from X.lightfield.exr or the light field inside X.luminaire.exr.
/// Throws Error with file, part and texel where the file is not one.
LightField read_lightfield(const std::string& path);

}  // namespace nearfield
