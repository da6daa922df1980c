#pragma once

template <class T>
deltadyn::Vector3<T> nothing();
