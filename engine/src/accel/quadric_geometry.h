// Spheres and disks as Embree user geometries: exact surfaces instead of triangles.
#pragma once

#include "accel/embree.h"
#include "geometry/disk.h"
#include "geometry/sphere.h"

namespace fluxfarm {

// The shape must outlive the geometry.
RTCGeometry make_sphere_geometry(RTCDevice device, const Sphere& sphere);
RTCGeometry make_disk_geometry(RTCDevice device, const Disk& disk);

}  // namespace fluxfarm
