// Closed lists of types: what there is, in the order of its numbers.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace ivory {

template <class... Types>
struct TypeList {
    static constexpr std::size_t size = sizeof...(Types);

    // To<Types...>, a std::variant for example.
    template <template <class...> class To>
    using Into = To<Types...>;
};

namespace type_list_detail {

template <std::size_t n, class List>
struct At;
template <std::size_t n, class First, class... Rest>
struct At<n, TypeList<First, Rest...>> : At<n - 1, TypeList<Rest...>> {};
template <class First, class... Rest>
struct At<0, TypeList<First, Rest...>> {
    using Type = First;
};

template <class Wanted, class List>
struct Index;
template <class Wanted, class... Types>
struct Index<Wanted, TypeList<Types...>> {
    static_assert((std::is_same_v<Wanted, Types> + ...) == 1, "it stands in the list, once");
    static constexpr std::size_t value = [] {
        std::size_t index = 0;
        static_cast<void>(((std::is_same_v<Wanted, Types> || (++index, false)) || ...));
        return index;
    }();
};

}  // namespace type_list_detail

// The type with that number, and the number of a type.
template <std::size_t n, class List>
using TypeAt = typename type_list_detail::At<n, List>::Type;

template <class Wanted, class List>
inline constexpr std::size_t index_in = type_list_detail::Index<Wanted, List>::value;

// Calls visit.operator()<Type>() for each, in order.
template <class... Types, class Visit>
constexpr void for_each_type(TypeList<Types...>, const Visit& visit) {
    (visit.template operator()<Types>(), ...);
}

// visit.operator()<Type>() of the type with that number, which there is. All give the same type.
template <class Only, class Visit>
constexpr decltype(auto) with_type(TypeList<Only>, std::size_t, const Visit& visit) {
    return visit.template operator()<Only>();
}
template <class First, class Second, class... Rest, class Visit>
constexpr decltype(auto) with_type(TypeList<First, Second, Rest...>, std::size_t number,
                                   const Visit& visit) {
    if (number == 0) return visit.template operator()<First>();
    return with_type(TypeList<Second, Rest...>{}, number - 1, visit);
}

}  // namespace ivory
