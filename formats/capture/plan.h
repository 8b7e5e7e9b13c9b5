// SPDX-License-Identifier: Apache-2.0
/// What a capture is to take: the plan that a person writes, and the list of shots that follows
/// from it.
#pragma once

#include "formats/capture/board.h"
#include "formats/capture/instruments.h"
#include "formats/files/json_field.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::capture {

constexpr int kPlanVersion = 2;  // 2: instruments, camera.controls

/// The camera and how it is set; the same for all shots but for the exposure.
struct CameraPlan {
    std::string device;  // address, serial number or name; empty: the only one there is
    std::string pixel_format = "Mono12";
    glm::ivec2 region_min_px{0}, region_size_px{0};  // size 0: all of the sensor
    double gain_db = 0;
    int packet_size_bytes = 0;  // 0: the largest that arrives
    bool is_byte_swapped = false;
    std::map<std::string, int> controls;  // of V4L2, by name as v4l2-ctl lists them: "gain"
    glm::dmat3 rgb_from_raw{1.0};  // linear Rec.709 from white-balanced raw colors, of a data sheet
};

/// Who moves filter, lamp and targets, as far as no instrument does: a person who is asked, or the
/// camera's own features (LabPosition..., as the virtual bench has them).
enum class StageKind { Manual, Camera };

/// Exposures of every position, ascending. Where `is_auto` they are found by metering.
struct BracketPlan {
    bool is_auto = false;
    std::vector<double> exposures_us;     // empty where is_auto
    double least_us = 20, most_us = 2e6;  // limits of is_auto
    double darkest_share = 1e-3;          // of the brightest pixel: what is_auto still exposes well
};

/// Where the target is in a view: on the screen's plane S, on the filter's plane U with the screen
/// taken away, or anywhere before the camera.
enum class TargetPlane { Screen, Filter, Free };

/// Looks at the filter itself, without the screen, against an even source behind it.
struct FilterViewPlan {
    std::vector<glm::ivec2> positions;  // columns and rows of the grid, each at most once
    double exposure_us = 0;             // 0: the bracket's middle one
};

/// A photometer whose head lies in S while positions are taken. Its readings are the frames'
/// `reading_lx`; they give the scale of all light.
struct PhotometerPlan {
    glm::dvec2 on_screen_board_m{0};  // its middle, in the board's frame of the first screen view
    /// Spectral mismatch correction, of a certificate for this lamp behind this filter: what a
    /// reading is multiplied by.
    double correction = 1;
    double sigma_rel = 0;     // random, of a reading
    double mismatch_rel = 0;  // systematic: what the correction leaves, and its own calibration
};

/// The screen's luminance factor against the viewing angle, relative to an ideal diffuser of its
/// own reflectance; linear between points. Empty: a diffuser.
struct ScreenPlan {
    std::vector<double> angle_deg;  // to the normal, ascending from 0
    std::vector<double> factor;     // 1 at 0
};

/// What to take, and what the lab knows of its parts.
struct Plan {
    CameraPlan camera;
    StageKind stage = StageKind::Manual;
    InstrumentsPlan instruments;
    glm::ivec2 grid{0};  // filter positions, columns x rows; 1 x 1: no filter; 0: targets alone
    glm::dvec2 pitch_m{0};
    std::string basis;
    glm::dvec3 filter_peak{1.0};  // transmission at the filter's center, by channel
    FilterViewPlan filter_views;
    BracketPlan bracket;
    int repeats = 1;
    int blocked = 0;      // at each of the bracket's exposures, a plate instead of the filter
    int darks = 4;        // for every exposure, lamp off
    int darks_after = 0;  // after the lights, at each of the bracket's exposures
    int flats = 0;        // of an even source before the lens, at each of their exposures
    std::vector<double> flat_exposures_us;  // ascending; empty: the bracket's middle one
    std::optional<BoardPlan> board;         // none: its views tell nothing
    std::vector<TargetPlane> views;         // of the board
    double target_exposure_us = 0;          // 0: the bracket's middle one
    ScreenPlan screen;
    std::optional<PhotometerPlan> photometer;
    int drift_every = 0;            // light positions between two looks at the reference; 0: never
    double drift_limit_rel = 0.01;  // stops where the lamp changed by more
    double ratio_limit_rel = 0.02;  // stops where exposures are in another ratio than asked for
    double settle_s = 0;            // waited after every move of an instrument
};

/// Blocked: an opaque plate instead of the filter, the lamp on: light that goes another way.
enum class ShotKind { Target, Flat, Filter, Dark, Blocked, Light, Reference };

/// One frame to take. Its number is its place in the plan's list, from 0; shots of one plan never
/// change their numbers.
struct Shot {
    int number = 0;
    ShotKind kind = ShotKind::Light;
    glm::ivec2 position{-1};  // of the filter, column and row; -1: not in the way
    int view = -1;            // of the target
    double exposure_us = 0;
    int repeat = 0;
};

/// Throws Error with the key's place where something is missing, of another kind or out of range.
/// A plan that a person wrote must say the exposures of all that it asks for; the one in an
/// import's header need not.
Plan read_plan(const std::string& path);
Plan plan_from(const JsonField& document);
Json json_of(const Plan& plan);

/// All frames of a plan in the order in which they are taken: targets, flats, filter views, darks
/// at every exposure of them and of the bracket, the blocked lamp, then positions in serpentine
/// order with their exposures and repeats, and a look at the reference every `drift_every`
/// positions. The bracket must be known.
std::vector<Shot> shots_of(const Plan& plan);

/// "light_x003_y002_1600us_r000": names a shot for people and in files' names.
std::string name_of(const Shot& shot);

std::string word_of(ShotKind kind);
ShotKind shot_kind_from(const JsonField& word);

/// The time that shots take, s: exposures, `overhead_s` a frame and settling after every move.
double estimate_time_s(const Plan& plan, const std::vector<Shot>& shots, double overhead_s);

/// Exposures a factor of at most sqrt(high / low) apart, so that every pixel between the brightest
/// and `darkest_share` of it lies within [low, high] of the camera's range in at least two of them.
///
/// In      brightest_per_us: signal of the brightest pixel, share of the range in a microsecond.
/// Throws  Error where least_us ... most_us does not hold them.
std::vector<double> bracket_of(const BracketPlan& plan,
                               double brightest_per_us,
                               double low,
                               double high);

}  // namespace nearfield::capture
