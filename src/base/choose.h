// One of two types, known when compiling: compilers for small chips come without <type_traits>. Internal to src/.
#pragma once

namespace thimble {

template <bool kFirst, class First, class Second>
struct Chosen {
  using Type = First;
};
template <class First, class Second>
struct Chosen<false, First, Second> {
  using Type = Second;
};
template <bool kFirst, class First, class Second>
using Choose = typename Chosen<kFirst, First, Second>::Type;

}  // namespace thimble
