// SPDX-License-Identifier: Apache-2.0
#include "acquire/exposure_list.h"

#include "formats/files/error.h"
#include "formats/files/read_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <utility>

namespace nearfield::acquire {

std::map<std::string, ListedExposure> read_exposure_list(const std::string& path) {
    std::istringstream text(read_file(path));
    std::map<std::string, ListedExposure> list;
    std::string line;
    bool has_count = false;
    for (int number = 1; std::getline(text, line); ++number) {
        line = line.substr(0, line.find('#'));
        std::istringstream words(line);
        std::string name;
        if (!(words >> name))
            continue;
        if (!std::exchange(has_count, true) &&
            name.find_first_not_of("0123456789") == std::string::npos)
            continue;
        double inverse_s = 0;
        ListedExposure exposure;
        if (!(words >> inverse_s >> exposure.f_number) || !(inverse_s > 0) ||
            !(exposure.f_number > 0))
            throw Error{"bad exposure list", fmt::format("{}, line {}", path, number),
                        "file name, 1 / shutter speed in s, f-stop, gain, ND", "'" + line + "'"};
        exposure.exposure_us = 1e6 / inverse_s;
        list.insert_or_assign(std::filesystem::path(name).stem().string(), exposure);
    }
    return list;
}

std::optional<std::string> find_exposure_list(const std::string& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().ends_with(".hdr_image_list.txt"))
            return entry.path().string();
    return std::nullopt;
}

}  // namespace nearfield::acquire
