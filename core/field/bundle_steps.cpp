#include "core/field/bundle_steps.h"

#include "core/field/window.h"
#include "core/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/field/bundle_steps.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include "core/field/condense.inl"
#include "core/field/curvature.inl"
#include "core/field/entries.inl"
#include "core/field/nearest_parts.inl"
#include "core/field/peaks.inl"
#include "core/field/places.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {

const BundleSteps& bundle_steps_of_target() {
    static const BundleSteps steps{bound,
                                   bound_clusters,
                                   keep_nearest_parts,
                                   keep_nearest_parts_local,
                                   bound_curvature,
                                   bound_across,
                                   enter_local,
                                   place_local,
                                   bound_members,
                                   bound_local,
                                   bound_curvature_local,
                                   bound_across_local,
                                   condense,
                                   condense_ray,
                                   coarse,
                                   coarse_local,
                                   fine,
                                   fine_in_float};
    return steps;
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(bundle_steps_of_target);

const BundleSteps& bundle_steps() { return HWY_DYNAMIC_DISPATCH(bundle_steps_of_target)(); }

}  // namespace ivory
#endif
