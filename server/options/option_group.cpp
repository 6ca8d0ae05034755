#include "server/options/option_group.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "common/option_range.h"

namespace brume {

NewOption& NewOption::range(int least, int most) {
    allow(option_, least, most);
    return *this;
}

NewOption& NewOption::range(uint32_t least, uint32_t most) {
    allow(option_, least, most);
    return *this;
}

NewOption& NewOption::range(double least, double most) {
    allow(option_, least, most);
    return *this;
}

NewOption& NewOption::oneOf(const std::vector<std::string>& words) {
    option_->check(CLI::IsMember(words));
    return *this;
}

NewOption& NewOption::check(const std::function<std::string(const std::string&)>& complaint) {
    option_->check(CLI::Validator([complaint](std::string& value) { return complaint(value); }, "", ""));
    return *this;
}

NewOption& NewOption::unit(const char* name) {
    option_->type_name(name);
    return *this;
}

NewOption& NewOption::standing(const std::string& value) {
    option_->default_str(value);
    return *this;
}

NewOption& NewOption::live() {
    table_.live.insert(option_);
    return *this;
}

NewOption& NewOption::flagOnly() {
    option_->configurable(false);
    return *this;
}

NewOption& NewOption::needs(const NewOption& other) {
    option_->needs(other.option_);
    return *this;
}

NewOption OptionGroup::add(CLI::Option* option) {
    if (name_) option->group(name_);
    return {table_, option};
}

template <class Value>
NewOption OptionGroup::option(const char* name, Value& value, const char* about) {
    return add(table_.app.add_option(name, value, about));
}

NewOption OptionGroup::several(const char* name, std::vector<std::string>& values, char delimiter, const char* about) {
    return add(table_.app.add_option(name, values, about)
                   ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                   ->delimiter(delimiter));
}

NewOption OptionGroup::milliseconds(const char* name, std::chrono::milliseconds& value, const char* about,
                                    uint32_t least) {
    const auto take = [&value](uint32_t ms) { value = std::chrono::milliseconds(ms); };
    return add(table_.app.add_option_function<uint32_t>(name, take, about))
        .standing(std::to_string(value.count()))
        .range(least, 3'600'000u)
        .unit("MS");
}

NewOption OptionGroup::mebibytes(const char* name, uint64_t& bytes, const char* about) {
    const auto take = [&bytes](uint32_t mib) { bytes = uint64_t{mib} << 20; };
    return add(table_.app.add_option_function<uint32_t>(name, take, about))
        .standing(std::to_string(bytes >> 20))
        .unit("MIB");
}

NewOption OptionGroup::perSecond(const char* name, double& value, const char* about) {
    return option(name, value, about).range(1.0, 100'000.0).unit("1/S");
}

NewOption OptionGroup::flag(const char* name, bool& value, const char* about) {
    return add(table_.app.add_flag(name, value, about));
}

NewOption OptionGroup::flag(const char* name, std::function<void(bool)> take, const char* about) {
    const auto value = std::make_shared<bool>(false);
    CLI::Option* flag = table_.app.add_flag(name, *value, about);
    table_.afterwards.push_back([value, flag, take = std::move(take)] {
        if (flag->count() > 0) take(*value);
    });
    return add(flag);
}

template NewOption OptionGroup::option(const char*, std::string&, const char*);
template NewOption OptionGroup::option(const char*, std::filesystem::path&, const char*);
template NewOption OptionGroup::option(const char*, uint8_t&, const char*);
template NewOption OptionGroup::option(const char*, uint16_t&, const char*);
template NewOption OptionGroup::option(const char*, uint32_t&, const char*);
template NewOption OptionGroup::option(const char*, double&, const char*);
template NewOption OptionGroup::option(const char*, std::optional<std::string>&, const char*);

} // namespace brume
