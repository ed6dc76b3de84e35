"""Pictures by vtkFixedPointVolumeRayCastMapper, for `caster = "vtk"` and `supple bench render`.

Prints "ready" when VTK is there. The first line on stdin is the path of a JSON file with the volume
(MetaImage), camera, lights, transfer function and size; the answer, "read". Then, for every line
{"step": mm, "shade": bool, "fresh": bool, "image": path or null}, draws one picture and prints
{"frame_ms", "cast_ms", "cast_origin", "cast_size", "base_mbytes", "peak_mbytes"}. A fresh picture is
the first one of a volume that has just changed. Rays are cast for the rectangle of cast_size pixels
from cast_origin, which counts from the lower left corner. Draws into a window of its own on DISPLAY;
images are on black, or transparent where the job says so, with colours multiplied by their opacity.
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
    if job['height'] is not None:
        camera.ParallelProjectionOn()
        camera.SetParallelScale(job['height'] / 2)
    renderer.ResetCameraClippingRange()
    renderer.AutomaticLightCreationOff()
    for given in job['lights']:
        light = vtkLight()
        light.SetLightTypeToCameraLight() if given['of_camera'] else light.SetLightTypeToSceneLight()
        light.SetPosition(given['direction'])
        light.SetFocalPoint(0, 0, 0)
        light.SetAmbientColor(1, 1, 1)
        light.SetDiffuseColor(given['rgb'])
        light.SetSpecularColor(given['rgb'])
        light.SetIntensity(given['intensity'])
        renderer.AddLight(light)
    window.SetOffScreenRendering(True)
    if job['transparent']:
        window.SetAlphaBitPlanes(True)
        renderer.SetBackgroundAlpha(0)
    window.SetSize(job['size'])
    window.AddRenderer(renderer)
    return window


def write_png(window, path, has_alpha):
    picture = vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.SetShouldRerender(False)
    picture.SetInputBufferTypeToRGBA() if has_alpha else picture.SetInputBufferTypeToRGB()
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(picture.GetOutputPort())
    writer.Write()


def main():
    print('ready', flush=True)
    with open(sys.stdin.readline().rstrip('\n')) as file:
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
    print('read', flush=True)
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
            write_png(window, wanted['image'], job['transparent'])
        cast = mapper.GetRayCastImage()
        print(json.dumps({'frame_ms': frame_ms, 'cast_ms': 1e3 * mapper.GetTimeToDraw(),
                          'cast_origin': cast.GetImageOrigin(),
                          'cast_size': cast.GetImageInUseSize(),
                          'base_mbytes': base, 'peak_mbytes': mbytes('VmHWM')}), flush=True)


main()
