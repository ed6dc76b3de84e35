"""VTK's side of `supple bench render`: pictures by vtkFixedPointVolumeRayCastMapper.

Argument: a JSON file with the volume (MetaImage), camera, transfer function and size. Then, for
every line {"step": mm, "shade": bool, "fresh": bool, "image": path or null} on stdin, draws one
picture and prints {"frame_ms", "cast_ms", "cast_origin", "cast_size", "base_mbytes",
"peak_mbytes"}. A fresh picture is the first one of a volume that has just changed. Rays are cast
for the rectangle of cast_size pixels from cast_origin, which counts from the lower left corner.
Draws into a window of its own on DISPLAY.
"""
import json
import sys
import time

import vtkmodules.vtkRenderingOpenGL2
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkLight, vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty,
    vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper


def mbytes(name):
    """VmRSS or VmHWM of this process."""
    with open('/proc/self/status') as status:
        return next(int(line.split()[1]) for line in status if line.startswith(name)) * 1024 / 1e6


def volume_property(job):
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for density, alpha in job['opacity']:
        opacity.AddPoint(density, alpha)
    for density, rgb in job['colour']:
        colour.AddRGBPoint(density, *rgb)
    found = vtkVolumeProperty()
    found.SetScalarOpacity(opacity)
    found.SetColor(colour)
    found.SetScalarOpacityUnitDistance(job['unit_distance_mm'])
    found.SetInterpolationTypeToLinear()
    found.SetAmbient(job['ambient'])
    found.SetDiffuse(job['diffuse'])
    found.SetSpecular(job['specular'])
    found.SetSpecularPower(job['specular_power'])
    return found


def window_of(job, volume):
    """A window with the volume, seen by the job's camera and lit from it."""
    renderer, window = vtkRenderer(), vtkRenderWindow()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(job['position'])
    camera.SetFocalPoint(job['target'])
    camera.SetViewUp(job['up'])
    camera.SetViewAngle(job['fov'])
    renderer.ResetCameraClippingRange()
    renderer.AutomaticLightCreationOff()
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    light.SetAmbientColor(1, 1, 1)
    renderer.AddLight(light)
    window.SetOffScreenRendering(True)
    window.SetSize(job['size'])
    window.AddRenderer(renderer)
    return window


def write_png(window, path):
    picture = vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.SetShouldRerender(False)
    picture.SetInputBufferTypeToRGB()
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(picture.GetOutputPort())
    writer.Write()


def main():
    with open(sys.argv[1]) as file:
        job = json.load(file)
    base = mbytes('VmRSS')
    reader = vtkMetaImageReader()
    reader.SetFileName(job['volume'])
    reader.Update()
    image = reader.GetOutput()
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetLockSampleDistanceToInputSpacing(False)
    mapper.SetImageSampleDistance(1)
    mapper.SetIntermixIntersectingGeometry(False)
    mapper.SetNumberOfThreads(job['threads'])
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(volume_property(job))
    window = window_of(job, volume)
    for line in sys.stdin:
        wanted = json.loads(line)
        mapper.SetSampleDistance(wanted['step'])
        volume.GetProperty().SetShade(wanted['shade'])
        if wanted['fresh']:
            image.Modified()
        begin = time.perf_counter()
        window.Render()
        frame_ms = 1e3 * (time.perf_counter() - begin)
        if wanted['image']:
            write_png(window, wanted['image'])
        cast = mapper.GetRayCastImage()
        print(json.dumps({'frame_ms': frame_ms, 'cast_ms': 1e3 * mapper.GetTimeToDraw(),
                          'cast_origin': cast.GetImageOrigin(),
                          'cast_size': cast.GetImageInUseSize(),
                          'base_mbytes': base, 'peak_mbytes': mbytes('VmHWM')}), flush=True)


main()
