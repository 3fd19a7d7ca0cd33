// One of two types, known when compiling: compilers for small chips come without <type_traits>. Internal to src/.
#ifndef THIMBLE_SRC_BASE_CHOOSE_H
#define THIMBLE_SRC_BASE_CHOOSE_H

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

#endif
