#include "core/math/instruction_sets.h"

#include <hwy/targets.h>

#include <cstdint>

namespace ivory {
namespace {

std::string_view name_of(std::int64_t target) {
    const std::string_view name = hwy::TargetName(target);
    return name.starts_with("AVX3") ? "AVX-512" : name;  // Highway's name for it
}

// Highway's targets are bits, the better the lower.
std::vector<std::int64_t> targets() {
    std::vector<std::int64_t> found;
    for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
        found.push_back(rest & -rest);
    }
    return found;
}

// Before the first limit.
const std::vector<std::int64_t>& all_targets() {
    static const std::vector<std::int64_t> all = targets();
    return all;
}

}  // namespace

std::vector<std::string_view> instruction_sets() {
    std::vector<std::string_view> names;
    for (const std::int64_t target : all_targets()) names.push_back(name_of(target));
    return names;
}

bool limit_instruction_set(std::string_view name) {
    for (const std::int64_t target : all_targets()) {
        if (name_of(target) != name) continue;
        hwy::DisableTargets(target - 1);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        return true;
    }
    return false;
}

std::string_view instruction_set() { return name_of(targets().front()); }

}  // namespace ivory
