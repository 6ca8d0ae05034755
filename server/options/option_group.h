// Options in groups, as --help shows them. Only its source and options.cpp compile CLI11.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace brume {

// All options of the program.
struct OptionTable {
    CLI::App& app;
    std::set<const CLI::Option*> live{};             // a reload can change them
    std::vector<std::function<void()>> afterwards{}; // called once all values are there
};

// An option that is being declared. What is allowed and what is shown can be added, in any order.
class NewOption {
public:
    NewOption(OptionTable& table, CLI::Option* option) : table_(table), option_(option) {}

    // Ends included. The type is shown in --help.
    NewOption& range(int least, int most);
    NewOption& range(uint32_t least, uint32_t most);
    NewOption& range(double least, double most);
    NewOption& oneOf(const std::vector<std::string>& words);
    // `complaint` returns what is allowed, or nothing for a value that is good.
    NewOption& check(const std::function<std::string(const std::string&)>& complaint);
    NewOption& unit(const char* name);             // of its values in --help
    NewOption& standing(const std::string& value); // what --help and --print-config show when nobody gives it
    NewOption& live();                             // a reload can change it
    NewOption& flagOnly();                         // neither in the file nor in the environment
    NewOption& needs(const NewOption& other);

private:
    OptionTable& table_;
    CLI::Option* option_;
};

class OptionGroup {
public:
    // Null: the group of --help.
    OptionGroup(OptionTable& table, const char* name) : table_(table), name_(name) {}

    // `value` holds the default, and outlives the parse. Its type is one of those at the end of option_group.cpp.
    template <class Value>
    NewOption option(const char* name, Value& value, const char* about);
    // May be given several times. In the environment `delimiter` stands between values.
    NewOption several(const char* name, std::vector<std::string>& values, char delimiter, const char* about);
    NewOption milliseconds(const char* name, std::chrono::milliseconds& value, const char* about, uint32_t least = 1);
    NewOption mebibytes(const char* name, uint64_t& bytes, const char* about);
    NewOption perSecond(const char* name, double& value, const char* about);
    NewOption flag(const char* name, bool& value, const char* about);
    // `take` gets the flag's value where somebody gives it: false is `--name=false`, or said by file or environment.
    NewOption flag(const char* name, std::function<void(bool)> take, const char* about);

private:
    NewOption add(CLI::Option* option);

    OptionTable& table_;
    const char* name_;
};

} // namespace brume
