// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"

#include <cerrno>
#include <system_error>
#include <utility>

namespace nearfield {
namespace {

std::string sentence(const std::string& what,
                     const std::string& where,
                     const std::string& expected,
                     const std::string& got) {
    std::string text = where.empty() ? what : where + ": " + what;
    if (!expected.empty())
        text += ": expected " + expected;
    if (!got.empty())
        text += (expected.empty() ? ": got " : ", got ") + got;
    return text;
}

}  // namespace

Error::Error(std::string what_failed,
             std::string where_found,
             std::string expected_value,
             std::string got_value)
    : std::runtime_error(sentence(what_failed, where_found, expected_value, got_value)),
      what_(std::move(what_failed)),
      where(std::move(where_found)),
      expected(std::move(expected_value)),
      got(std::move(got_value)) {}

std::string system_error() {
    return std::generic_category().message(errno);
}

}  // namespace nearfield
