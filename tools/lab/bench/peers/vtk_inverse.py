"""VTK's inversion of a displacement field, for `supple bench invert`.

Arguments: folder, threads, nx, ny, nz. Reads u.raw, writes o.raw (floats, three per voxel, i
fastest) and prints the milliseconds of the inversion.
"""
import sys
import time

from vtkmodules.vtkFiltersHybrid import vtkGridTransform, vtkTransformToGrid
from vtkmodules.vtkIOImage import vtkImageReader2, vtkMetaImageWriter

folder, _, nx, ny, nz = sys.argv[1], *map(int, sys.argv[2:6])
reader = vtkImageReader2()
reader.SetFileName(folder + '/u.raw')
reader.SetFileDimensionality(3)
reader.SetDataExtent(0, nx - 1, 0, ny - 1, 0, nz - 1)
reader.SetDataScalarTypeToFloat()
reader.SetNumberOfScalarComponents(3)
reader.SetDataByteOrderToLittleEndian()
reader.Update()
transform = vtkGridTransform()
transform.SetDisplacementGridData(reader.GetOutput())
transform.SetInterpolationModeToLinear()
transform.Update()
grid = vtkTransformToGrid()
grid.SetInput(transform.GetInverse())
grid.SetGridExtent(0, nx - 1, 0, ny - 1, 0, nz - 1)
grid.SetGridScalarTypeToFloat()
begin = time.perf_counter()
grid.Update()
milliseconds = 1e3 * (time.perf_counter() - begin)
writer = vtkMetaImageWriter()
writer.SetInputData(grid.GetOutput())
writer.SetCompression(False)
writer.SetFileName(folder + '/o.mhd')
writer.SetRAWFileName(folder + '/o.raw')
writer.Write()
print(milliseconds)
