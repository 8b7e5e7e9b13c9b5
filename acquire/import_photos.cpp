// SPDX-License-Identifier: Apache-2.0
#include "acquire/import_photos.h"

#include "acquire/exposure_list.h"
#include "formats/files/error.h"
#include "formats/photos/photo.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>

namespace nearfield::acquire {
namespace {

using capture::Frame;
using photos::Photo;

// What names of photographs end in, and the format that a reader finds inside.
constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kEndings = {
    {{".png", "png"},
     {".jpg", "jpeg"},
     {".jpeg", "jpeg"},
     {".tif", "tiff"},
     {".tiff", "tiff"},
     {".dng", "raw"},
     {".cr2", "raw"},
     {".nef", "raw"},
     {".arw", "raw"},
     {".raf", "raw"},
     {".rw2", "raw"}}};

/// The format that a file's name promises; empty: no photograph.
std::string_view promised_format(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    for (const auto& [known, format] : kEndings)
        if (ending == known)
            return format;
    return {};
}

std::vector<std::filesystem::path> photographs_in(const std::string& folder) {
    std::error_code failed;
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failed))
        if (!promised_format(entry.path()).empty())
            paths.push_back(entry.path());
    if (failed)
        throw Error{"cannot import", folder, "a folder of photographs", failed.message()};
    if (paths.empty())
        throw Error{"cannot import", folder, "photographs (png, jpg, tif, dng, cr2, nef ...)",
                    "none"};
    std::sort(paths.begin(), paths.end());
    return paths;
}

/// One photograph's place in the capture.
struct Import {
    std::filesystem::path path;
    std::optional<double> exposure_us, f_number, iso;
    glm::ivec2 size_px{0};
};

/// What the photographs say of themselves, and what is odd about it.
struct Survey {
    std::vector<Import> imports;
    bool is_linear = true;
    std::string make, model;
    std::vector<std::string> remarks;
};

void remark_photo(const std::filesystem::path& path, const Photo& photo, Survey& survey) {
    const std::string name = path.filename().string();
    if (photo.format != promised_format(path))
        survey.remarks.push_back(fmt::format("{}: its name says {}, its content is {}", name,
                                             promised_format(path), photo.format));
    if (const int border = border_pixels(photo.frame); border > 0)
        survey.remarks.push_back(
            fmt::format("{}: {} pixels of one pure color reach the edge: shifted image areas, not "
                        "light; leave them out",
                        name, border));
}

bool is_bracket(const std::vector<Import>& imports) {
    std::set<double> exposures_us;
    for (const Import& import : imports)
        exposures_us.insert(import.exposure_us.value_or(0));
    return !exposures_us.contains(0) && exposures_us.size() > 1;
}

template <typename Get>
bool differ(const std::vector<Import>& imports, const Get& get) {
    return std::any_of(imports.begin(), imports.end(),
                       [&](const Import& import) { return get(import) != get(imports.front()); });
}

void remark_differences(Survey& survey) {
    if (differ(survey.imports, [](const Import& import) { return import.size_px; }))
        survey.remarks.emplace_back("sizes differ");
    if (!is_bracket(survey.imports))
        return;
    if (differ(survey.imports, [](const Import& import) { return import.f_number; }))
        survey.remarks.emplace_back("apertures differ: exposures do not compare by time alone");
    if (differ(survey.imports, [](const Import& import) { return import.iso; }))
        survey.remarks.emplace_back("ISO differs: exposures do not compare by time alone");
}

void use_list(const std::string& photo_folder, Survey& survey) {
    const std::optional<std::string> path = find_exposure_list(photo_folder);
    if (!path)
        return;
    std::map<std::string, ListedExposure> list = read_exposure_list(*path);
    for (Import& import : survey.imports) {
        const auto listed = list.find(import.path.stem().string());
        if (listed == list.end()) {
            survey.remarks.push_back(import.path.filename().string() +
                                     ": not in the exposure list");
            continue;
        }
        import.exposure_us = listed->second.exposure_us;
        import.f_number = listed->second.f_number;
        list.erase(listed);
    }
    if (!list.empty())
        survey.remarks.push_back(
            fmt::format("the exposure list names {} pictures that are not there, the first is {}",
                        list.size(), list.begin()->first));
}

// Reads every photograph once, for what it says: frames are read again when they are written, so
// that one is in memory.
Survey survey_of(const std::string& photo_folder, const std::function<void(double)>& progress) {
    Survey survey;
    const std::vector<std::filesystem::path> paths = photographs_in(photo_folder);
    for (const std::filesystem::path& path : paths) {
        const Photo photo = photos::read_photo(path.string());
        remark_photo(path, photo, survey);
        survey.imports.push_back(
            {path, photo.exposure_us, photo.f_number, photo.iso, photo.frame.size_px});
        survey.is_linear = survey.is_linear && photo.is_linear;
        survey.make = photo.make;
        survey.model = photo.model;
        if (progress)
            progress(0.5 * static_cast<double>(survey.imports.size()) /
                     static_cast<double>(paths.size()));
    }
    use_list(photo_folder, survey);
    remark_differences(survey);
    return survey;
}

capture::FrameRecord record_of(const Import& import, int number, bool is_light) {
    capture::FrameRecord record;
    record.shot.number = number;
    record.shot.kind = is_light ? capture::ShotKind::Light : capture::ShotKind::Target;
    record.shot.position = is_light ? glm::ivec2(0) : glm::ivec2(-1);
    record.shot.view = is_light ? -1 : number;
    record.shot.exposure_us = import.exposure_us.value_or(0);
    record.exposure_us = record.shot.exposure_us;
    record.source = import.path.filename().string();
    return record;
}

// A plan whose shots are the photographs: views of the board, by hand, and nothing else.
capture::Plan views_plan(const Survey& survey, const capture::BoardPlan& board) {
    capture::Plan plan;
    plan.board = board;
    plan.views.assign(survey.imports.size(), capture::TargetPlane::Free);
    if (!differ(survey.imports, [](const Import& import) { return import.exposure_us; }))
        plan.target_exposure_us = survey.imports.front().exposure_us.value_or(0);
    plan.darks = 0;
    return plan;
}

capture::CaptureHeader header_of(const Survey& survey, const ImportOptions& options) {
    capture::CaptureHeader header;
    if (options.board)
        header.plan = views_plan(survey, *options.board);
    header.response = survey.is_linear ? capture::Response::Linear : capture::Response::Unknown;
    header.provenance.program = program_version();
    header.provenance.command = "capture";
    header.provenance.options = {{"import", "photographs"}};
    for (const Import& import : survey.imports)
        header.provenance.inputs.push_back(describe_input(import.path.string()));
    return header;
}

bool is_pure_primary(const Frame& frame, std::size_t pixel) {
    const int range_dn = frame.range_dn();
    int full = 0, empty = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        full += frame.values[3 * pixel + c] == range_dn ? 1 : 0;
        empty += frame.values[3 * pixel + c] == 0 ? 1 : 0;
    }
    return full == 1 && empty == 2;
}

}  // namespace

int border_pixels(const Frame& frame) {
    if (frame.channels != 3)
        return 0;
    const glm::ivec2 size = frame.size_px;
    const auto at = [&](glm::ivec2 p) {
        return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(size.x) +
               static_cast<std::size_t>(p.x);
    };
    std::vector<bool> is_seen(frame.values.size() / 3);
    std::vector<glm::ivec2> open;
    const auto visit = [&](glm::ivec2 p) {
        if (p.x < 0 || p.y < 0 || p.x >= size.x || p.y >= size.y || is_seen[at(p)] ||
            !is_pure_primary(frame, at(p)))
            return;
        is_seen[at(p)] = true;
        open.push_back(p);
    };
    for (int x = 0; x < size.x; ++x)
        for (const int y : {0, size.y - 1})
            visit({x, y});
    for (int y = 0; y < size.y; ++y)
        for (const int x : {0, size.x - 1})
            visit({x, y});
    int count = 0;
    for (; !open.empty(); ++count) {
        const glm::ivec2 p = open.back();
        open.pop_back();
        for (const glm::ivec2 step :
             {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)})
            visit(p + step);
    }
    return count;
}

ImportResult import_photos(const std::string& photo_folder,
                           const std::string& capture_folder,
                           const ImportOptions& options,
                           const std::function<void(double fraction)>& progress) {
    const Survey survey = survey_of(photo_folder, progress);
    ImportResult result{static_cast<int>(survey.imports.size()),
                        !options.board && is_bracket(survey.imports), survey.remarks};
    capture::CaptureWriter writer =
        capture::CaptureWriter::create(capture_folder, header_of(survey, options));
    writer.add(capture::SessionRecord{
        1, fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))), program_version(),
        survey.make, survey.model, "", 0});
    for (const std::string& remark : survey.remarks)
        writer.add(capture::EventRecord{1, 0, "import", remark});
    for (int k = 0; k < result.photographs; ++k) {
        const Import& import = survey.imports[static_cast<std::size_t>(k)];
        const Photo photo = photos::read_photo(import.path.string());
        capture::FrameRecord record = record_of(import, k, result.is_bracket);
        record.pixel_format =
            fmt::format("{}{}", photo.frame.channels == 3 ? "RGB" : "Mono", photo.frame.bits);
        writer.add(photo.frame, std::move(record));
        if (progress)
            progress(0.5 + 0.5 * (k + 1) / result.photographs);
    }
    return result;
}

}  // namespace nearfield::acquire
