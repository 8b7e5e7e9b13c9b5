// SPDX-License-Identifier: Apache-2.0
/// The virtual bench: a lamp with known radiance behind a filter, a diffuse screen, a camera. It
/// gives what a camera would give, raw numbers with noise, and its own truth
/// (docs/virtual_bench.md).
///
/// Frames (metres, right-handed). `bench` is the slab's frame of the light field to be measured:
/// the nominal screen plane S is z = 0, the nominal filter plane U is z = -delta_m, light goes
/// towards +z. `filter` and `screen` are the real planes, tilted: x and y in the plane, origin on
/// bench's z axis. `camera` looks along +z, x right, y down in the picture (the frame in which
/// Brown's distortion is written). `board` has its origin in the top left corner of the printed
/// area, x right, y down, hence z into the board; a camera sees it from z < 0. `lamp` is the lamp's
/// luminaire frame.
///
/// Pictures have their first row at the top; pixel (x, y) covers x ... x + 1, its center lies at
/// (x + 0.5, y + 0.5), and so are cx, cy meant. Colors are linear Rec.709; luminous quantities.
///
/// Every random number is a hash of (seed, what it is for, frame number or place, pixel): a Shot
/// gives the same pixels whatever the threads or the order of calls.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace nearfield::sample_data {

/// How the lamp is measured.
enum class Setup {
    Filter,   // filter of known transmission on U, diffuse screen on S, camera looks at the screen
    Pinhole,  // an opaque plate with a round hole on U instead of the filter
    Direct,   // no screen: the camera's center stands on U and looks into the lamp
};

struct BenchLamp {
    std::string file;  // light field or luminaire of one slab; empty: the headlight
    std::uint64_t headlight_seed = 1;
    /// The lamp's frame to nominal U's (bench moved by delta_m along z). Identity: the headlight's
    /// lens lies on U.
    Rigid u_from_lamp;
    double warm_up_rel = 0.0;  // light at time t: 1 + warm_up_rel * exp(-t / warm_up_s) ...
    double warm_up_s = 300.0;
    double walk_sigma_rel = 0.0;  // ... times 1 + a slow random walk of this sigma
    double walk_s = 60.0;         // time in which the walk forgets
};

/// Filter (or plate with a hole, or the camera's center) and the stage that carries it.
struct BenchFilter {
    Profile profile;                // transmission along x and y: peak * phi(x) * phi(y)
    glm::ivec2 grid{9, 7};          // positions of the stage: columns, rows
    glm::dvec2 pitch_m{0.0};        // nominal step; also the profile's unit of length
    glm::dvec2 center_m{0.0};       // nominal center of all positions on U
    glm::dvec3 transmission{1.0};   // peak, by channel
    double hole_radius_m = 0.0005;  // Setup::Pinhole
    glm::dvec2 tilt_deg{0.0};       // of the plane, about bench's x, then y
    glm::dvec2 stage_scale{1.0};    // real step over nominal
    double stage_skew_deg = 0.0;    // the stage's y axis leans towards +x
    double step_sigma_m = 0.0;      // error of a position, by axis, drawn once a position
};

struct BenchScreen {
    glm::dvec2 min_m{-0.5}, max_m{0.5};  // its rectangle, in `screen`
    glm::dvec2 tilt_deg{0.0};            // about bench's x, then y
    glm::dvec3 reflectance{0.8};         // rho, by channel; the same on both sides
    double lobe_share = 0.0;             // L = rho / pi * E * (1 - share + share * cos^exponent)
    double lobe_exponent = 2.0;          // cosine of the angle to the screen's normal
};

enum class Mosaic { Mono, Rggb };

struct BenchCamera {
    glm::ivec2 size_px{512, 512};
    Mosaic mosaic = Mosaic::Mono;
    int bits = 12;  // 8 ... 16
    double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
    double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
    Rigid bench_from_camera;       // Setup::Direct: its translation is not used
    double vignetting_cos4 = 1.0;  // exponent's share: cos^(4 * this)
    glm::dvec3 vignetting{0.0};    // 1 + v.x r^2 + v.y r^4 + v.z r^6, r = 1 in the corner
    double psf_sigma_px = 0.7;     // gaussian core, besides the pixel's own square
    double veil_share = 0.0;       // share of the light in a wide gaussian
    double veil_sigma_px = 40.0;
    /// Electrons per pixel and second at 1 cd/m^2 in R, G and B of the scene; rows: pixel colors
    /// R, G, B (Mono: the first).
    glm::dmat3 response_e_per_cd_m2_s{1.0};  // response[scene channel][pixel color]
    double gain_e_per_dn = 2.5;              // at 0 dB
    double full_well_e = 10000.0;
    double read_noise_e = 6.0;
    double black_level_dn = 64.0;
    double dark_e_per_s = 5.0;  // at the reference temperature
    double dark_reference_c = 25.0;
    double dark_doubling_c = 7.0;
    double sensor_start_c = 25.0;  // at time 0
    double sensor_rise_c = 0.0;    // final rise: start + rise * (1 - exp(-t / rise_s))
    double sensor_rise_s = 900.0;
    double prnu_sigma_rel = 0.0;   // of a pixel's response
    double dsnu_sigma_rel = 0.0;   // of a pixel's dark current
    double offset_sigma_dn = 0.0;  // of a pixel's black level
    double hot_share = 0.0;        // share of pixels with hot_factor times dark current
    double hot_factor = 200.0;
};

struct BenchStray {
    double veil_lx = 0.0;  // white light on the screen and on the photometer, always
    /// Share of the light held back by filter or plate that reaches screen and photometer all the
    /// same: what the part in view loses on average, times this, evenly.
    double blocked_share = 0.0;
};

struct BenchPhotometer {
    glm::dvec3 position_m{0.0, 0.0, 3.0};  // in bench; looks along normal
    glm::dvec3 normal{0.0, 0.0, -1.0};
    glm::dvec3 channel_factor{1.0};  // V(lambda) mismatch: reading = sum factor * weight * E
    double sigma_rel = 0.0, sigma_lx = 0.0;
};

/// A ChArUco board: squares with markers of OpenCV's DICT_4X4_50 in the white ones, ids row by row.
struct BenchBoard {
    glm::ivec2 squares{8, 6};
    double square_m = 0.03, marker_m = 0.022;
    double margin_m = 0.01;  // white around the printed area
    double black = 0.04, white = 0.85;
};

enum class BoardPlane { Screen, Filter, Free };  // the frame in which a view's pose is given

/// One picture of the board. Its real pose is the given one after a small random turn and shift.
struct TargetView {
    BoardPlane plane = BoardPlane::Screen;
    Rigid plane_from_board;  // Free: bench_from_board
};

struct BenchTargets {
    BenchBoard board;
    std::vector<TargetView> views;
    double hand_sigma_deg = 0.0, hand_sigma_m = 0.0;  // of Free poses
    double room_lx = 500.0;                           // white light on the board
};

/// Accuracy against time of prepare().
struct BenchAccuracy {
    double lens_step = 1.0;       // spacing of quadrature nodes on the lens, relative
    double screen_step_px = 1.0;  // spacing of irradiance samples on the screen, in pixels
    int subsamples = 2;           // samples of a pixel's square along an axis (targets: twice that)
};

/// All that there is to say about a bench. Numbers are what they really are; what a measurer
/// would believe in (no tilt, scale 1) is the rest of the names.
struct Bench {
    std::uint64_t seed = 1;
    Setup setup = Setup::Filter;
    double delta_m = 0.2;  // nominal distance of U and S
    BenchLamp lamp;
    BenchFilter filter;
    BenchScreen screen;
    BenchCamera camera;
    BenchStray stray;
    BenchPhotometer photometer;
    BenchTargets targets;
    double flat_cd_m2 = 1000.0;  // luminance of the flat field's source
    BenchAccuracy accuracy;
};

/// Reads and checks a bench (JSON, docs/virtual_bench.md). A lamp file's path is relative to it.
/// Throws Error with file, key, expected and got.
Bench read_bench(const std::string& path);
void write_bench(const Bench& bench, const std::string& path);

/// Throws Error naming `where` and key if a value is out of its range.
void check(const Bench& bench, const std::string& where);

/// What the camera is shown.
enum class Subject {
    Position,  // the filter (hole, camera) at Shot::position
    Open,      // nothing on U (Setup::Direct: not possible)
    Blocked,   // an opaque plate on U: stray light alone (Setup::Direct: not possible)
    Flat,      // an even source of flat_cd_m2 before the lens
    Target,    // the board in pose Shot::target_view
    Filter,    // the filter (plate) at Shot::position itself, without the screen, against an even
               // source of flat_cd_m2 behind it (Setup::Direct: not possible)
    Cap,       // the lens is covered
};

struct Shot {
    Subject subject = Subject::Position;
    glm::ivec2 position{0};  // column, row of the stage: column rises with x, row with y
    int target_view = 0;     // index in BenchTargets::views
    bool lamp_on = true;     // for Position, Open, Blocked; room light stays
    double exposure_us = 10000;
    double gain_db = 0;
    double time_s = 0;  // at the exposure's middle, since lamp and camera were switched on
    std::uint64_t frame_number = 0;  // noise differs between frames of different numbers
};

/// A bench with its optics computed: opaque, shared, immutable.
struct PreparedBench;
using Prepared = std::shared_ptr<const PreparedBench>;

/// Computes all pictures that do not depend on exposure: every position's, the open lamp's, the
/// targets'.
///
/// In      progress(fraction): may be empty; called from one thread at a time
/// Throws  Error if the bench is wrong (check()), its lamp cannot be read, or the pictures would
///         take more than 4 GiB.
/// Cost    9 x 7 positions, 512 x 512 pixels: seconds (docs/virtual_bench.md). Parallel (TBB).
Prepared prepare(const Bench& bench, const std::function<void(double fraction)>& progress = {});

/// The bench that it was made from.
const Bench& bench_of(const PreparedBench& prepared);

/// Raw numbers of one exposure, [row from the top][column], 0 ... 2^bits - 1.
/// Throws Error if the Shot's position or view does not exist, or exposure or gain are not finite
/// and >= 0. Thread-safe. Cost: milliseconds at 512 x 512 (docs/virtual_bench.md); Subject::Filter
/// is computed anew each time.
std::vector<std::uint16_t> expose(const PreparedBench& prepared, const Shot& shot);

/// Expected electrons of a pixel without fixed pattern, saturation and dark current, per second
/// and with the lamp at its nominal light, [row from the top][column]: what noise is added to.
std::vector<float> signal_e_per_s(const PreparedBench& prepared, const Shot& shot);

/// The photometer's reading in lux. Subject::Position, Open and Blocked; room light alone
/// otherwise.
double photometer_lx(const PreparedBench& prepared, const Shot& shot);

/// The lamp's light at a time relative to its nominal, and the sensor's temperature.
double lamp_factor(const Bench& bench, double time_s);
double sensor_c(const Bench& bench, double time_s);

/// Writes the bench as realized, random errors drawn included, with fluxes and the estimated error
/// of the optics (JSON): for tests and reports alone, no stage of a measurement reads it.
void write_truth(const PreparedBench& prepared, const std::string& path);

}  // namespace nearfield::sample_data
