#include "core/trace/packet_steps.h"

#include "core/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/packet_steps.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include "core/trace/certify.inl"
#include "core/trace/enclose.inl"
#include "core/trace/packet_lanes.inl"
#include "core/trace/surfaces.inl"
#include "core/trace/walk.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {

const PacketSteps& steps_of_target() {
    static const PacketSteps steps{prepare, any,  walk,    walk_again, enclose,
                                   certify, look, surface, conclude};
    return steps;
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(steps_of_target);

const PacketSteps& packet_steps() { return HWY_DYNAMIC_DISPATCH(steps_of_target)(); }

}  // namespace ivory
#endif
