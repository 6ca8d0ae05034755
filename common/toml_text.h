// TOML from outside: parsed only if it is flat enough. The parser recurses, and so does what it makes.
#pragma once

#include <string>
#include <string_view>

#include <toml++/toml.h>

namespace brume {

// toml::parse(). Throws toml::parse_error, also for a key of more than 16 parts ("a.b.c" has three) and for more than
// 16 tables inside each other.
toml::table parseToml(std::string_view text, const std::string& name = {});

// What is wrong, in the parser's words, and what to do: about the mistakes that people make most.
std::string syntaxProblem(const toml::parse_error& error);

} // namespace brume
