// (o - c) + t d for far o and c: what cancels is not lost.
#pragma once

#include <cmath>

namespace ivory {

// (o - c) + t d to nearly twice the precision before its one rounding: the sum and the product
// without error (Knuth's TwoSum; Dekker's product by fma), their low parts added last. With
// u = 2^-53, within u |v| + 8 u^2 (|o - c| + |t d|) of the exact v.
inline double offset(double o, double c, double t, double d) {
    const double difference = o - c;
    const double back = difference - o;
    const double difference_low = (o - (difference - back)) - (c + back);
    const double product = t * d;
    const double product_low = std::fma(t, d, -product);
    const double sum = difference + product;
    const double sum_back = sum - difference;
    const double sum_low = (difference - (sum - sum_back)) + (product - sum_back);
    return sum + (sum_low + (difference_low + product_low));
}

}  // namespace ivory
