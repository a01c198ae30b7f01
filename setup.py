"""Read by catkin_python_setup(), not by people: use catkin_make, catkin build or ./robocop."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import find_packages, setup

setup(
    **generate_distutils_setup(
        packages=find_packages("src"),
        package_dir={"": "src"},
        package_data={
            "aro_robocop_goto_as": ["*/*.[ch]", "*/*/*.c"],  # whose structures Python reads
            "robocop_grading.report": ["templates/*.html"],
        },
    )
)
