// SPDX-License-Identifier: Apache-2.0
#include "app/options.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <numeric>

namespace nearfield::app {
namespace {

/// Letters to insert, remove or replace to make one word of the other (Levenshtein 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

/// ", did you mean --width?" where one of the names is near, else nothing.
std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
    constexpr std::size_t kNear = 2;  // two slips of the finger
    const auto nearest =
        std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
            return edit_distance(word, a) < edit_distance(word, b);
        });
    const bool is_near = nearest != names.end() && edit_distance(word, *nearest) <= kNear;
    return is_near ? fmt::format(", did you mean {}?", *nearest) : "";
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    return fmt::format("'{}' is not expected{}", word, suggestion(word, names));
}

}  // namespace

CLI::App* add_command(CLI::App& app,
                      const std::string& name,
                      const std::string& description,
                      const std::vector<std::string>& examples) {
    CLI::App* command = app.add_subcommand(name, description);
    command->footer(fmt::format("Examples:\n  {}", fmt::join(examples, "\n  ")));
    return command;
}

std::vector<std::pair<std::string, std::string>> same_words(const std::vector<std::string>& words) {
    std::vector<std::pair<std::string, std::string>> choices;
    choices.reserve(words.size());
    for (const std::string& word : words)
        choices.emplace_back(word, word);
    return choices;
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
    return option->get_type_size() == 0 ? "" : " " + option->get_type_name();
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
    std::string text = option->get_description();
    if (!option->get_default_str().empty())
        text += "; default " + option->get_default_str();
    return option->get_required() ? text + " (required)" : text;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({}))
        names.push_back(command->get_name());
    return fmt::format("no command '{}'{}; there are {}", word, suggestion(word, names),
                       fmt::join(names, ", "));
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
    const std::vector<CLI::App*> called = app.get_subcommands();
    const std::vector<std::string> rest = app.remaining();
    if (called.empty())
        return rest.empty() ? "no command given" : unknown_command(app, rest.front());
    // A command's leftovers are known from CLI11's message alone, which ends with them.
    const std::string colon = ": ";
    std::string message = error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
        const std::string words = message.substr(message.rfind(colon) + colon.size());
        return unknown_option(*called.front(), words.substr(0, words.find(' ')));
    }
    return message;
}

std::optional<glm::ivec2> parse_size(const std::string& text) {
    constexpr int kMost = 9999;
    glm::ivec2 size{0};
    const char* end = text.data() + text.size();
    const auto x = std::from_chars(text.data(), end, size.x);
    if (x.ec != std::errc() || x.ptr == end || *x.ptr != 'x')
        return std::nullopt;
    const auto y = std::from_chars(x.ptr + 1, end, size.y);
    const bool is_good = y.ec == std::errc() && y.ptr == end && size.x >= 1 && size.y >= 1 &&
                         size.x <= kMost && size.y <= kMost;
    return is_good ? std::optional(size) : std::nullopt;
}

void check_size(glm::ivec2 grid, glm::ivec2 texels) {
    constexpr std::int64_t kMost = std::int64_t{1} << 30;
    const std::int64_t images = std::int64_t{grid.x} * grid.y;
    const std::int64_t size = std::int64_t{texels.x} * texels.y;
    if (images > kMost / size)
        throw CLI::ValidationError(
            "--grid, --texels", fmt::format("expected {} values a channel at most, got {} images "
                                            "of {}",
                                            kMost, images, size));
}

}  // namespace nearfield::app
