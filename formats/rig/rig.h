// SPDX-License-Identifier: Apache-2.0
/// A calibrated measurement bench: what turns frames into light on the plane S, behind a filter
/// that is known on the plane U. Written by calibrate, read by fit (docs/rig.md).
///
/// Two files: NAME.json holds numbers; NAME.maps.exr, where there is radiometry, the values that
/// differ from pixel to pixel.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/files/provenance.h"
#include "formats/rig/lens.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::rig {

constexpr int kRigVersion = 1;

/// The two planes in the camera's frame.
///
/// The slab's frame follows from what was measured: S is its plane z = 0, +z where light goes; its
/// x axis is the stage's x direction projected on S; its origin lies below the middle of all filter
/// positions. U is the plane z = -delta_m, parallel to S: what the real plane is tilted against it
/// stands in `u_tilt_rad` and in the positions' own z.
struct Planes {
    Rigid camera_from_slab;
    double delta_m = 0;          // distance of the grid's middle from S
    glm::dvec2 u_tilt_rad{0};    // U's turn against S about the slab's x and y axis
    glm::ivec2 grid{0};          // filter positions: columns, rows
    glm::dvec2 pitch_m{0};       // mean step along the stage's axes
    double skew_rad = 0;         // the stage's y axis leans towards its +x
    double filter_turn_rad = 0;  // the filter's own x axis against the slab's, about z
    /// Where the filter's center really is, in the slab: [row * columns + column]; z near -delta_m.
    std::vector<glm::dvec3> position_m;
};

/// A scalar that was estimated. Its unit is in the name: "delta_m".
struct Parameter {
    std::string name;
    double value = 0;
    double sigma = 0;  // one standard deviation; 0: exact or given
};

/// Exposures: what the plan asked for and what they are in truth, up to one common factor.
struct TrueExposure {
    double asked_us = 0;
    double true_us = 0;
    double sigma_rel = 0;  // of the ratio to the reference exposure
};

/// A factor of something against an angle or a level, linear between points, ascending in x.
struct Curve {
    std::vector<double> x, y;
};

/// How values follow light.
///
///     dark  = room_dn_per_s[p] + (dark_dn_per_s[p] - room_dn_per_s[p]) dark_growth(T - T_dark)
///     rate  = (linear(DN) - black_dn[p] - dark t_asked) / t_true                         in DN/s
///     light = remove_veil(rate) / response[p]                                (rig/veil.h) in DN/s
///     E on S = scale_lx_s_per_dn * light / screen(angle of view)                          in lx
struct Radiometry {
    int bits = 0;
    std::string mosaic = "mono";  // "mono", "rggb", "grbg", "gbrg", "bggr" or "rgb"
    double saturation_dn = 0;     // values from here on are not to be used
    double gain_e_per_dn = 0, gain_sigma = 0;
    double read_noise_dn = 0;       // of one frame, quantization included
    double prnu_sigma_rel = 0;      // what is left of it after flat-field correction
    double dark_temperature_c = 0;  // T_dark, at which dark_dn_per_s was taken
    double linearity_rel = 0;       // largest deviation from a straight line that was seen
    Curve linear;                   // DN to linear DN; empty: the camera is linear
    std::vector<TrueExposure> exposures;
    double veil_share = 0, veil_sigma_px = 0;  // of light that the lens spreads: a wide gaussian
    Curve screen;         // luminance factor against the angle of view, rad; 1 at 0
    double stray_lx = 0;  // on S with the lamp off (already in the dark frames)
    double scale_lx_s_per_dn = 1;
    double scale_sigma_rel = 0;       // random: the photometer's noise, counts
    double scale_systematic_rel = 0;  // V(lambda) mismatch, the photometer's calibration
    bool is_absolute = false;         // else scale is 1 and light is in relative units
    glm::dmat3 rgb_from_raw{1.0};     // linear Rec.709 from the mosaic's white-balanced colors
    Profile filter_profile;  // transmission along x and y, peak 1; unit of length: `filter_pitch_m`
    glm::dvec2 filter_pitch_m{0};
    glm::dvec3 filter_peak{1.0};  // transmission at its center, by channel
};

/// Values of every pixel, [row from the top][column]; "rgb": [row][column][channel].
struct Maps {
    glm::ivec2 size_px{0};
    std::vector<float> black_dn, dark_dn_per_s;
    std::vector<float> response;  // of the pixel with the lens before it; mean 1 by color, no veil
    std::vector<float> response_sigma_rel;
    std::vector<float> is_bad;         // 1: hot or dead, not to be used
    std::vector<float> room_dn_per_s;  // of dark_dn_per_s, what does not grow with temperature
};

/// What dark current is multiplied by when the sensor gets warmer: silicon's doubles every 6 to 8
/// C.
double dark_growth(double warmer_c);

/// The same at a frame's temperature; 1 where that is not known.
double dark_growth(const Radiometry& radiometry, std::optional<double> temperature_c);

/// What pixel `p` gives without the lamp's light.
inline double dark_rate_dn_per_s(const Maps& maps, std::size_t p, double growth) {
    const double room = maps.room_dn_per_s[p];
    return room + growth * (double(maps.dark_dn_per_s[p]) - room);
}

/// What a capture could tell: photographs of a board give a lens alone, a bracket a response.
struct Rig {
    std::optional<Lens> lens;
    std::optional<Planes> planes;
    std::optional<Radiometry> radiometry;
    std::vector<Parameter> parameters;       // all that were estimated, for people and for tests
    std::vector<std::string> covariance_of;  // names of `parameters`, in the matrix' order
    std::vector<double> covariance;          // of those, row by row
    Provenance provenance;
};

/// Throws Error naming `where` and key where a number is out of range, sizes do not fit, or nothing
/// is there.
void check(const Rig& rig, const std::string& where);

/// Writes both files, maps first: the rig is there when all of it is. Without radiometry there are
/// no maps.
void write_rig(const Rig& rig,
               const Maps& maps,
               const std::optional<RunRecord>& run,
               const std::string& path);
/// Throws Error naming file and key.
Rig read_rig(const std::string& path);
/// The maps beside a rig's file. Throws Error where they are not those that the rig was written
/// with.
Maps read_maps(const std::string& rig_path);

}  // namespace nearfield::rig
