// SPDX-License-Identifier: Apache-2.0
/// Folders of photographs become captures.
#pragma once

#include "formats/capture/capture.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::acquire {

struct ImportResult {
    int photographs = 0;
    bool is_bracket = false;           // of one scene, by exposure; else views of a target
    std::vector<std::string> remarks;  // what is odd about them, also in the capture's log
};

/// What is known of photographs besides themselves.
struct ImportOptions {
    std::optional<capture::BoardPlan> board;  // they are views of it, whatever their exposures
};

/// Writes a folder's photographs (PNG, JPEG, TIFF, raw; by name) as a capture's frames. Exposures
/// are those of a list NAME.hdr_image_list.txt (file name, 1 / shutter speed in s, f-stop, gain in
/// dB, ND), else of EXIF, else unknown. Photographs with two or more different known exposures are
/// a bracket, others views of a target; views of a known board get a plan that says so.
///
/// Noticed and said: files whose content is another format than their name says, listed files that
/// are not there, borders of one pure color (shifted image areas), sizes, apertures or ISO that
/// differ. Throws  Error where there is no photograph, one cannot be read, or the capture cannot be
/// written. Memory  one photograph.
ImportResult import_photos(const std::string& photo_folder,
                           const std::string& capture_folder,
                           const ImportOptions& options,
                           const std::function<void(double fraction)>& progress);

/// Pixels of one pure primary color (one channel at the range's end, the others 0) that reach the
/// frame's edge through their like: image areas that were shifted away, not light. 0 for one
/// channel.
int border_pixels(const capture::Frame& frame);

}  // namespace nearfield::acquire
