// SPDX-License-Identifier: Apache-2.0
/// How commands declare their options, so that help, range, default and refusal read alike in all.
/// What the user got wrong ends as CLI::ParseError: one line on stderr, exit code 2.
#pragma once

#include "formats/files/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/glm.hpp>

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::app {

/// Declares a command whose help ends with examples.
CLI::App* add_command(CLI::App& app,
                      const std::string& name,
                      const std::string& description,
                      const std::vector<std::string>& examples);

/// Help as "--width PX   what it is, 1 ... 16384; default 640".
class HelpFormatter : public CLI::Formatter {
  public:
    std::string make_option_opts(const CLI::Option* option) const override;
    std::string make_option_desc(const CLI::Option* option) const override;
};

/// A usage error as one line that names the option, what was expected and what was got.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

/// "no command 'pak', did you mean pack? There are demo, ...".
std::string unknown_command(const CLI::App& app, const std::string& word);

/// "11x9" as two numbers, each 1 ... 9999; nothing where it is anything else.
std::optional<glm::ivec2> parse_size(const std::string& text);

/// Throws a usage error where W x H images of w x h texels would be more than any light field
/// (2^30 values a channel, 4 GiB).
void check_size(glm::ivec2 grid, glm::ivec2 texels);

/// An option whose text is refused with "expected EXPECTED, got '...'" unless `accepts` it.
template <typename Accepts>
CLI::Option* add_checks(CLI::Option* option, const std::string& expected, const Accepts& accepts) {
    return option->check([expected, accepts](const std::string& text) {
        return accepts(text) ? std::string() : fmt::format("expected {}, got '{}'", expected, text);
    });
}

/// A number within least ... most, both included; `value` may be optional. `unit` stands for it in
/// the help.
template <typename Value, typename Number>
CLI::Option* add_number(CLI::App& command,
                        const std::string& name,
                        Value& value,
                        Number least,
                        Number most,
                        const std::string& unit,
                        const std::string& help) {
    const std::string range = fmt::format("{} ... {}", least, most);
    CLI::Option* option = command.add_option(name, value, help + " (" + range + ")");
    if constexpr (std::is_arithmetic_v<Value>)
        option->default_str(fmt::format("{}", value));
    add_checks(option->type_name(unit), range, [least, most](const std::string& text) {
        if (std::is_unsigned_v<Number> && text.starts_with('-'))
            return false;  // which CLI11 would wrap around
        Number number{};
        return CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
    });
    return option;
}

/// --seed, any number of its type.
template <typename Seed>
CLI::Option* add_seed(CLI::App& command, Seed& seed, const std::string& help) {
    return add_number(command, "--seed", seed, Seed{0}, std::numeric_limits<Seed>::max(), "N",
                      help);
}

/// One of a few words.
template <typename Value>
CLI::Option* add_choice(CLI::App& command,
                        const std::string& name,
                        Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices,
                        const std::string& help) {
    std::vector<std::string> words;
    std::string chosen;
    for (const auto& [word, meaning] : choices) {
        words.push_back(word);
        if (meaning == value)
            chosen = word;
    }
    const auto find = [choices](const std::string& text) {
        return std::find_if(choices.begin(), choices.end(),
                            [&](const auto& choice) { return choice.first == text; });
    };
    CLI::Option* option = command.add_option_function<std::string>(
        name, [&value, find](const std::string& text) { value = find(text)->second; }, help);
    option->default_str(chosen)->type_name(fmt::format("{}", fmt::join(words, "|")));
    return add_checks(option, fmt::format("{}", fmt::join(words, ", ")),
                      [words](const std::string& text) {
                          return std::find(words.begin(), words.end(), text) != words.end();
                      });
}

/// Words that mean themselves, for add_choice.
std::vector<std::pair<std::string, std::string>> same_words(const std::vector<std::string>& words);

/// A size WxH; `value` may be optional.
template <typename Value>
CLI::Option* add_size(CLI::App& command,
                      const std::string& name,
                      Value& value,
                      const std::string& help) {
    CLI::Option* option = command.add_option_function<std::string>(
        name, [&value](const std::string& text) { value = *parse_size(text); }, help);
    if constexpr (std::is_same_v<Value, glm::ivec2>)
        option->default_str(fmt::format("{}x{}", value.x, value.y));
    return add_checks(option->type_name("WxH"), "two numbers 1 ... 9999, as in 13x11",
                      [](const std::string& text) { return parse_size(text).has_value(); });
}

/// Runs a library's own check of options; what it refuses is the user's mistake.
template <typename Check>
void check_options(const Check& check) {
    try {
        check();
    } catch (const Error& error) {
        throw CLI::ValidationError(error.what());
    }
}

}  // namespace nearfield::app
