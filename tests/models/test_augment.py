import numpy as np
import torch

from models.data.augment import augment
from tests.models.made import crops


def test_form_and_range_are_kept_and_all_is_drawn_from_the_generator() -> None:
    made = crops(12)
    images, maps = torch.from_numpy(made.images)[:, None].float(), torch.from_numpy(made.maps).float() / 255

    def changed(seed: int) -> tuple[torch.Tensor, torch.Tensor]:
        return augment(images, maps, torch.Generator().manual_seed(seed))

    first, again, other = changed(1), changed(1), changed(2)
    assert first[0].shape == images.shape
    assert first[1].shape == maps.shape
    assert float(first[0].min()) >= 0
    assert float(first[0].max()) <= 255
    assert torch.equal(first[0], again[0])
    assert not torch.equal(first[0], other[0])


def test_the_map_moves_with_the_image() -> None:
    made = crops(60)
    defects = made.pick(made.labels > 0)
    images, maps = (
        torch.from_numpy(defects.images)[:, None].float(),
        torch.from_numpy(defects.maps).float() / 255,
    )
    moved, where = augment(images, maps, torch.Generator().manual_seed(0))
    darker = 0
    for image, map_ in zip(moved.numpy()[:, 0], where.numpy(), strict=True):
        covered = np.kron(map_.max(axis=0), np.ones((4, 4))) > 0.6
        darker += bool(covered.any() and image[covered].mean() < image[~covered].mean())
    assert darker >= 0.95 * len(defects)
