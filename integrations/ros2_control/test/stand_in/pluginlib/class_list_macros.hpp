#pragma once
#include <memory>
// The one class of a plug-in, made by its base.
#define PLUGINLIB_EXPORT_CLASS(Class, Base) \
    std::unique_ptr<Base> plugin() { return std::make_unique<Class>(); }
