// SPDX-License-Identifier: Apache-2.0
#include "formats/files/provenance.h"

#include "formats/files/error.h"
#include "formats/files/json_field.h"
#include "formats/files/metadata.h"
#include "formats/files/provenance_json.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <xxhash.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>

namespace nearfield {
namespace {

// As `xxh128sum` prints it.
std::string as_text(XXH128_hash_t hash) {
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string program_version() {
    return "nearfield " NEARFIELD_VERSION;
}

std::string hash_file(const std::string& path) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    if (!file)
        throw Error{"cannot read file", path, "", system_error()};
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                                XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::vector<char> block(std::size_t{1} << 20);
    std::size_t size = 0;
    while ((size = std::fread(block.data(), 1, block.size(), file.get())) > 0)
        XXH3_128bits_update(state.get(), block.data(), size);
    if (std::ferror(file.get()) != 0)
        throw Error{"cannot read file", path, "", system_error()};
    return as_text(XXH3_128bits_digest(state.get()));
}

std::string hash_bytes(std::string_view bytes) {
    return as_text(XXH3_128bits(bytes.data(), bytes.size()));
}

Provenance::Input describe_input(const std::string& path) {
    return {std::filesystem::path(path).filename().string(), hash_file(path)};
}

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

RunRecord finish_run(double start_s, int threads) {
    RunRecord run;
    run.date_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    run.time_s = now_s() - start_s;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    run.peak_memory_mib = static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux gives KiB
    run.threads = threads;
    return run;
}

Json json_of(const Provenance& provenance) {
    Json options = Json::array(), inputs = Json::array(), figures = Json::array();
    for (const auto& [name, value] : provenance.options)
        options.push_back({{"name", name}, {"value", value}});
    for (const Provenance::Input& input : provenance.inputs)
        inputs.push_back({{"name", input.name}, {"xxh128", input.xxh128}});
    for (const auto& [name, value] : provenance.figures) {
        if (!std::isfinite(value))
            throw Error{"bad figure", "provenance, " + name, "a finite number",
                        fmt::format("{}", value)};
        figures.push_back({{"name", name}, {"value", value}});
    }
    return {{"program", provenance.program},
            {"command", provenance.command},
            {"options", options},
            {"inputs", inputs},
            {"figures", figures}};
}

Provenance provenance_from(const JsonField& root) {
    Provenance provenance;
    provenance.program = root.at("program").text();
    provenance.command = root.at("command").text();
    for (const JsonField& option : root.at("options").elements())
        provenance.options.emplace_back(option.at("name").text(), option.at("value").text());
    for (const JsonField& input : root.at("inputs").elements())
        provenance.inputs.push_back({input.at("name").text(), input.at("xxh128").text()});
    for (const JsonField& figure : root.at("figures").elements())
        provenance.figures.emplace_back(figure.at("name").text(), figure.at("value").number());
    return provenance;
}

exr::Attributes provenance_attributes(const Provenance& provenance,
                                      const std::optional<RunRecord>& run) {
    exr::Attributes attributes = {{kProvenanceAttribute, json_text(json_of(provenance))}};
    if (run)
        attributes.emplace_back(kRunAttribute, json_text({{"date_utc", run->date_utc},
                                                          {"time_s", run->time_s},
                                                          {"peak_memory_mib", run->peak_memory_mib},
                                                          {"threads", run->threads}}));
    return attributes;
}

Provenance read_provenance(const exr::Reader& reader, const std::string& path) {
    const std::optional<std::string> text = reader.attribute(kProvenanceAttribute);
    if (!text)
        return {};
    const std::string where = path + ", " + kProvenanceAttribute;
    const Json document = parse_json(*text, where);
    return provenance_from({document, where});
}

std::optional<RunRecord> read_run(const exr::Reader& reader, const std::string& path) {
    const std::optional<std::string> text = reader.attribute(kRunAttribute);
    if (!text)
        return std::nullopt;
    const std::string where = path + ", " + kRunAttribute;
    const Json document = parse_json(*text, where);
    const JsonField root(document, where);
    constexpr int kMaxThreads = 1 << 20;
    RunRecord run;
    run.date_utc = root.at("date_utc").text();
    run.time_s = root.at("time_s").number();
    run.peak_memory_mib = root.at("peak_memory_mib").number();
    run.threads = root.at("threads").integer(0, kMaxThreads);
    return run;
}

}  // namespace nearfield
