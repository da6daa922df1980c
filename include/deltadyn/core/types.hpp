#pragma once

/// \file
/// Fixed-size Eigen aliases used throughout. All quantities are SI.

#include <Eigen/Core>

namespace deltadyn {

template <class T, int N>
using Vector = Eigen::Matrix<T, N, 1>;
template <class T, int N>
using RowVector = Eigen::Matrix<T, 1, N>;
template <class T, int R, int C>
using Matrix = Eigen::Matrix<T, R, C>;

template <class T>
using Vector3 = Vector<T, 3>;
template <class T>
using Matrix3 = Matrix<T, 3, 3>;

}  // namespace deltadyn
