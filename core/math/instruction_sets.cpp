#include "core/math/instruction_sets.h"

#include <hwy/targets.h>

#include <cstddef>
#include <cstdint>

namespace ivory {
namespace {

std::string_view name_of(std::int64_t target) {
    const std::string_view name = hwy::TargetName(target);
    return name.starts_with("AVX3") ? "AVX-512" : name;  // Highway's name for it
}

// Highway's targets are bits, the better the lower. To ask for them makes the best one be used
// again, so that it is done once.
const std::vector<std::int64_t>& targets() {
    static const std::vector<std::int64_t> all = [] {
        std::vector<std::int64_t> found;
        std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS;
        for (; rest != 0; rest &= rest - 1) found.push_back(rest & -rest);
        return found;
    }();
    return all;
}

std::size_t in_use = 0;  // of the targets

}  // namespace

std::vector<std::string_view> instruction_sets() {
    std::vector<std::string_view> names;
    for (const std::int64_t target : targets()) names.push_back(name_of(target));
    return names;
}

bool limit_instruction_set(std::string_view name) {
    for (std::size_t k = 0; k < targets().size(); ++k) {
        if (name_of(targets()[k]) != name) continue;
        hwy::DisableTargets(targets()[k] - 1);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        in_use = k;
        return true;
    }
    return false;
}

std::string_view instruction_set() { return name_of(targets()[in_use]); }

}  // namespace ivory
