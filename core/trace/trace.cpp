#include "core/trace/trace.h"

namespace ivory {

Answer trace(const Field& field, const ElementList& list, const Ray& ray, const Method& method,
             const MethodOptions& options, Counts& counts) {
    Answer answer;
    answer.isolation = method.isolate(field, list, ray, options, counts);
    const Status status = answer.isolation.status;
    if (status != Status::miss && status != Status::claimed_miss) {
        answer.surface = method.surface(field, list, ray, midpoint(answer.isolation.t), options);
    }
    return answer;
}

}  // namespace ivory
