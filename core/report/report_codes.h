#pragma once
/* Every code a line of the report may carry: X(code, what it means, what to do about it). report_add accepts no other
 * code, and the reference page is made from this list. */
#define REPORT_CODES(X) \
    X("plan.recognised", "The folder has no plan.json; its parts were found by their file names.", \
      "Check the parts; write a plan.json to name them and to give units.") \
    X("plan.ignored-file", "A file in the folder looks like a part but was not used.", \
      "Name it in plan.json if it belongs to it.") \
    X("file.read", "What a file of the folder was read as.", "Nothing.") \
    X("file.not-read", "A file of the folder is of a kind that is not read, or is not named in plan.json.", \
      "If it belongs to the plan, convert it to a format that is read, or name it in plan.json.") \
    X("plan.too-many-files", "The folder holds more files or deeper folders than are looked at.", \
      "Move what does not belong to the plan elsewhere, or name the parts in a plan.json.") \
    X("plan.unknown-key", "plan.json has a key that is not known.", "Check its spelling.") \
    X("geometry.assumed", "The file does not say where the grid lies in the patient.", \
      "Left and right, or the thickness of a single plane, may be wrong: export again with them.") \
    X("geometry.unit-assumed", "The file's unit cannot be right for a patient; another was taken.", \
      "Check a known distance; correct the unit in the header.") \
    X("geometry.unit-given", "The plan gives another unit of length than a file's header.", "The plan's was used.") \
    X("geometry.unit-doubtful", "The grid is too small for a patient in the unit the file gives.", \
      "Check a known distance; correct the unit in the header.") \
    X("geometry.extent-differs", "Number of voxels times their size is not the extent the header gives.", \
      "Check the header; the voxel size was used.") \
    X("geometry.orientation-differs", "The slice orientation and the axis codes of a header disagree.", \
      "Check left and right; the axis codes were used.") \
    X("geometry.forms-disagree", "The two orientations a NIfTI file may carry (sform, qform) differ.", \
      "Check left and right; the sform was used.") \
    X("geometry.borrowed", "An image's header was wrong about its grid; the grid of the univels was taken.", \
      "Check that image and regions fit; correct the header.") \
    X("geometry.centred", \
      "The header does not say where the picture lies across its plane; it was centred on the axes.", \
      "Check that image and regions fit.") \
    X("registration.read", "The folder says how two frames of reference lie to each other.", \
      "Nothing; it is applied where a part needs it.") \
    X("registration.applied", "A part was brought into the image's frame of reference by a registration.", \
      "Check on anatomy that the two fit.") \
    X("registration.not-applied", "A registration is not rigid, or cannot be used.", \
      "Parts of the two frames of reference are not used together.") \
    X("patient.several", "The files name several patients.", \
      "Open a folder that holds one patient's plan alone, or compare the identities.") \
    X("patient.conflict", "Files with one patient ID differ in name or birth date.", \
      "Find out whose files they are before the plan is used.") \
    X("patient.none", "The files, or some of them, do not say whose they are.", \
      "Check by other means that the parts are of one person.") \
    X("patient.stated-differs", "The files name another patient than a person has stated.", \
      "Find out whose plan it is, and withdraw the statement.") \
    X("patient.statement-unread", "The files could not be compared with those that a person's statement was made of.", \
      "Have the plan read anew once its files can be read.") \
    X("patient.stated", "The files name no patient; a person has stated whose they are.", \
      "Nothing, if that is right; else withdraw the statement.") \
    X("plan.structs-absent", "A treatment plan was made for a structure set that is not in the folder.", \
      "Add the structure set.") \
    X("dose.plan-absent", "A dose refers to a treatment plan that is not in the folder.", \
      "Add the plan, or accept the dose in the room.") \
    X("image.slices-differ", "The header's number of slices is not what the data holds.", \
      "The data was believed; correct the header.") \
    X("image.locations-differ", "Slice positions and reference location with spacing disagree.", \
      "The positions were used; correct the header.") \
    X("image.locations-uneven", "Slice positions are a little uneven; an even spacing was fitted.", \
      "Check distances along the slices.") \
    X("image.precision", "Whole numbers too large to be held exactly were rounded.", \
      "Store the image with a smaller range.") \
    X("image.may-be-region", "An image holds a few whole numbers, so it may be the labels or the mask of regions.", \
      "Give it a name with _seg or _mask where the line says so, or name it and the other files in a plan.json.") \
    X("image.by-content", "A file is named like labels or a dose, but its values are those of an image.", \
      "Rename the file, or say in a plan.json what it is.") \
    X("image.constant", "Every voxel of an image has the same value.", "Check the file.") \
    X("image.place-assumed", "The header of an image does not say where it lies.", \
      "Check that it fits the other parts.") \
    X("image.bytes-behind", "A file holds more bytes than its header speaks of.", \
      "Check that the header belongs to these voxels.") \
    X("image.not-finite", "Some values are not numbers.", "They are drawn as nothing and probed as nothing.") \
    X("image.padding", "Pixels of a DICOM image hold its padding value: nothing was measured there.", \
      "Nothing; they have no value, and are drawn as nothing.") \
    X("image.hu-doubtful", "A CT has no value below zero, so its numbers may not be HU.", \
      "Check the rescale slope and intercept.") \
    X("dicom.unreadable", "A DICOM file cannot be read.", \
      "Check or copy the file again; the rest is shown without it.") \
    X("part.unreadable", "A part of the plan cannot be read.", \
      "Check or copy the file again; the rest is shown without it.") \
    X("dicom.not-used", "DICOM objects of a kind that has no place in a plan.", \
      "Nothing; they are left out: the line says what they are.") \
    X("dicom.bad-number", "A value of a DICOM file is no number, or cannot be what it stands for.", \
      "The file is damaged: copy or export it again.") \
    X("dicom.text", "Names in a DICOM file are not in the character set that the file states, or it is unknown.", \
      "Bytes without a meaning are shown as their numbers; export again with the right character set.") \
    X("dicom.same-uid", "Two DICOM objects have one SOP Instance UID and other contents.", \
      "Both are used. Keep the one that is meant: what refers to that UID may mean either.") \
    X("dicom.surplus-pixels", "A DICOM file holds more pixels than the frames it declares.", \
      "The declared frames are shown; check how the file was written.") \
    X("dicom.duplicate", "A DICOM object is there more than once.", "Nothing; the first by name was used.") \
    X("dicom.too-many", "There are more DICOM objects than are kept.", \
      "Open a folder that holds one patient's plan alone.") \
    X("image.split", "A series holds pictures that do not make one volume.", \
      "Each stack of slices became an image of its own.") \
    X("image.slices-stray", \
      "A few pictures of a series have another size, spacing, orientation or frame of reference than the others.", \
      "They are missing among the others; one of the files may be damaged.") \
    X("image.slices-missing", "Slices are missing between others.", \
      "They were interpolated between their neighbours; look for the missing files.") \
    X("image.slices-resampled", "The distances between slices differ too much for one grid.", \
      "The image was interpolated to even slices; slices at even places kept their values.") \
    X("image.slices-repeated", "Several slices lie at the same place.", "One of each was used; check the series.") \
    X("image.slices-shifted", "Slices are shifted sideways against each other.", \
      "They were placed on a straight line.") \
    X("image.gantry-tilt", "Slices are not stacked at right angles (gantry tilt).", \
      "Nothing; the image is kept sheared, as taken.") \
    X("image.thickness-differs", "The thickness of the slices is not the distance between them.", \
      "Nothing; the distance between their positions was used.") \
    X("image.single-slice", "The image has one slice.", "Its thickness was taken from the file, or is 1 mm.") \
    X("image.inverted", "The image asks for low values to be white (MONOCHROME1).", \
      "They are drawn so, and the values stay; the scene's image.low_values, a switch in the page, makes them black.") \
    X("image.slices-contradict", \
      "Slices of one series say different things of their pixels: sign, bits, unit, scale.", \
      "Each slice was read as it says; one of the files may be damaged.") \
    X("image.slopes-differ", "Slices have a scale of their own.", "Nothing; all were brought to one unit.") \
    X("image.rescale", "The scale of values is not one that can be used.", \
      "Check the values; they were taken as stored.") \
    X("image.coded-otherwise", "A JPEG 2000 codestream says something else of its values than the file around it.", \
      "Check some values: bits come from the codestream, the sign from the file.") \
    X("image.lossy", "The pixels were compressed with loss.", "Do not measure small differences in them.") \
    X("image.frames-left-out", "Frames of a file do not belong to one volume.", \
      "Those of the first orientation and time were used.") \
    X("geometry.cosines", "The directions of rows and columns are not at right angles or not of length 1.", \
      "They were corrected; check angles.") \
    X("region.empty", "A region has no voxel.", "Nothing to show for it; check the file.") \
    X("region.none", "A label map is 0 everywhere.", "Nothing to show for it; check the file.") \
    X("region.unnamed", "A label has no name.", "It is listed under its number; add it to the list of names.") \
    X("region.names-elsewhere", "A list of label names is of another map, or of a map that is not there.", \
      "Check the names; say in plan.json which list belongs to which map.") \
    X("region.names-limit", "The lists of label names of a folder are larger than the limit.", \
      "Remove lists that are not needed, or name each list in a plan.json.") \
    X("region.unused-names", "The list of names has labels that no voxel carries.", "Nothing; they are not listed.") \
    X("region.surroundings", "The filling around the patient is not listed as a region.", "Nothing.") \
    X("region.absent", "A region is marked ABSENT by its file and not listed.", "Nothing.") \
    X("region.renamed", "Two regions have the same name.", "They are told apart by their ids; rename one.") \
    X("region.roi-number", "Regions and contours of a structure set do not belong together by their numbers.", \
      "Check the file; see the line.") \
    X("region.segments", "How the frames of a segmentation became regions.", "Nothing.") \
    X("region.no-contours", "Regions of a structure set have nothing drawn.", "Nothing; they are not listed.") \
    X("region.contours-filled", "How the contours of a region became voxels: the method, both volumes.", "Nothing.") \
    X("region.contours-coarse", \
      "The voxels of a region differ from its contours by more than 1 % (5 % below 1 cm3), and finer ones were too many.", \
      "Its volume and histogram are approximate.") \
    X("region.contours-refused", "The contours of a region are beyond a limit, so it is not shown.", \
      "Draw it with fewer points.") \
    X("region.too-many", "A file holds more regions than a plan; the first ones are shown.", \
      "Write a file with fewer regions.") \
    X("region.contours-gap", "Contours are missing between others of a region.", \
      "Nothing was filled there; check that it is two parts.") \
    X("region.contours-beyond", \
      "Contours reach beyond the image: it has fewer slices than they were drawn on, or is smaller.", \
      "The regions are whole, on a grid that continues the image; look for the missing slices.") \
    X("region.contours-outside", "Contours reach more than 2 m beyond the image.", \
      "What lies outside is not shown; check that they belong together.") \
    X("region.contours-overlap", "Contours of one plane partly overlap; their union was filled.", \
      "Compare the volume with the treatment planning system: programs differ here.") \
    X("region.contours-differ", \
      "The voxels of a region differ by 2 % or more (5 % below 1 cm3) from the areas of its contours, added up another way.", \
      "Look at the region slice by slice, and compare its volume with the treatment planning system.") \
    X("region.contours-moved", "Contours lie beside the slices that they were filled on.", \
      "Nothing, if the distance is a part of a slice; else check that they belong to this image.") \
    X("region.contours-not-planar", "Contours are not flat.", "They were flattened into their mean plane.") \
    X("region.contours-left-out", \
      "Contours that enclose nothing, are not numbers, are there twice or tilted were left out.", \
      "Check the region where it was drawn.") \
    X("region.contours-open", "Points and open contours enclose nothing.", "They were left out.") \
    X("region.contours-count", "A structure set says another number of points than it has.", \
      "The points there are were taken; check the region.") \
    X("region.no-frame", "Nothing says that regions and image share a frame of reference.", "Check that they fit.") \
    X("region.frame-differs", "Regions were drawn in another frame of reference than the image's.", \
      "They may be shifted: check that they fit.") \
    X("mask.fractional", "A mask holds values between 0 and 1.", "Half and more counts as inside.") \
    X("hierarchy.derived", "No file says what lies inside what; it was derived from containment.", \
      "Check the tree; give a hierarchy in plan.json.") \
    X("hierarchy.unknown-name", "The hierarchy in plan.json names a region that is not there.", "Check the spelling.") \
    X("hierarchy.cycle", "The hierarchy says that a region lies inside itself.", "The line was left out; correct it.") \
    X("hierarchy.line", "A line of the hierarchy file is not \"outer > inner\".", \
      "The line was left out; correct it.") \
    X("dose.unsupported", "A dose is in a format this version does not read.", "The rest is shown without it.") \
    X("dose.no-unit", "The plan does not say the dose's unit.", "Numbers carry no unit; add \"unit\" in plan.json.") \
    X("dose.no-per", "The plan does not say what the dose is per.", "Add \"per\" in plan.json.") \
    X("dose.unit-differs", "The plan gives another unit than the dose's file is in.", \
      "The file's was used; correct plan.json.") \
    X("dose.no-quantity", "A dose file does not hold the quantity the plan asks it for.", \
      "Check \"quantity\" in plan.json.") \
    X("dose.bad-values", "A dose file holds values that are no numbers, or too large for their columns.", \
      "They are drawn as nothing and probed as nothing.") \
    X("dose.sets-differ", "The runs joined in a dose file had different sources.", \
      "The first was used; edit the dose again.") \
    X("dose.absurd-outside", "A dose is many times higher outside the regions than anywhere inside.", \
      "Scale by the largest value inside, or by the file's reference.") \
    X("dose.unknown-column", "A column of SERA's contours has a name that is not known, or one that is there twice.", \
      "It was left out; check dose_comp in the .chd file.") \
    X("dose.column-order", "The columns of SERA's contours stand in another order than seraMC's.", \
      "They were taken by their names.") \
    X("dose.unknown-version", "SERA's contours come from a version that was not tested.", \
      "Compare some values with their source.") \
    X("dose.weights-missing", "SERA's contours do not say their weights or ppm.", "1 was taken; check the scale.") \
    X("dose.weight-zero", "A column of SERA's contours was multiplied by 0.", \
      "It was left out; write the contours with weights of 1.") \
    X("dose.boron-ratio", "Boron in SERA's contours contains each tissue's ratio to blood, which no file stores.", \
      "Write contours with ratios of 1, or use the .rst file.") \
    X("dose.total-boron", "The total of SERA's contours contains boron as they assume it, and may contain weights.", \
      "Use the components for anything but a look.") \
    X("dose.planes-uneven", "The planes of SERA's contours are not evenly spaced.", "They were resampled, linearly.") \
    X("dose.outside-mesh", "Points of SERA's contours lie outside the dose's mesh.", \
      "They are drawn as nothing and probed as nothing.") \
    X("dose.no-reference", "A dose file's own reference is 0 or missing.", "Percentages need another reference.") \
    X("dose.mask-unread", "The pictures of regions beside SERA's contours are missing or do not fit.", \
      "Where the dose is valid was taken from its points.") \
    X("dose.doubtful", "A dose in Gy is higher than any treatment's.", "Check the unit and the scaling in its file.") \
    X("dose.negative", "A dose holds negative values.", "They are kept; check the source.") \
    X("dose.offsets-doubtful", "The offsets of a dose's frames begin neither at 0 nor at the first frame's position.", \
      "Check that the dose lies where it belongs.") \
    X("dose.offsets-uneven", "The frames of a dose are not evenly spaced.", "It was interpolated onto even planes.") \
    X("dose.single-plane", "A dose is a single plane.", "Nothing; it is as thick as the line says.") \
    X("dose.histograms-left-out", "Stored histograms of a dose are not read.", \
      "Histograms are computed from the dose; only the file's own figures to compare with are missing.") \
    X("dose.all-zero", "A dose is 0 everywhere.", "It is not listed; export it again if it should not be.") \
    X("dose.components", "Several objects are the components of one dose, by their descriptions.", \
      "Check the assignment.") \
    X("dose.words-not-joined", \
      "Doses are called like the components of one dose, but nothing else says that they are one.", \
      "Join them as \"components\" in a plan.json if they are.") \
    X("dose.per-ppm", "A boron dose for a known concentration was divided by it.", \
      "Nothing; the concentration in blood is set beside the picture.") \
    X("dose.no-ppm", "Nothing says for which concentration a boron dose holds.", \
      "It does not follow the concentration that is set.") \
    X("dose.not-summed", "Doses of single beams stand one beside the other.", \
      "Nothing was added; export the plan's dose for the sum.") \
    X("dose.type", "A dose object is of a type that may not be a dose.", "Check what the numbers mean.") \
    X("dose.left-out", "There are more doses than the limit, or files of several patients in one.", \
      "Some are not listed.") \
    X("dose.no-frame", "Nothing says that dose and image share a frame of reference.", "Check that they fit.") \
    X("dose.frame-differs", "A dose is in another frame of reference than the image.", \
      "It may be shifted: check that it fits.") \
    X("dose.tally", "A dose is a field that a Monte Carlo code added up.", \
      "Check axes, factor and the place of the largest value against the code's own plot.") \
    X("dose.mask-grid", "The mask of a dose lies on another grid than the dose.", "It is looked up by position.") \
    X("beam.left-out", "A beam of a treatment plan cannot be placed in the patient, or is for setting up only.", \
      "It is not shown; see the line.") \
    X("beam.bad-value", \
      "A treatment plan holds values that cannot be: out of range, out of order, or not as many as they should be.", \
      "Do not rely on the beam; check or export the plan again.") \
    X("beam.ion", "A treatment plan with ions: only what it has in common with other plans is read.", \
      "Nothing; do not look for more in the picture of its beams.") \
    X("beam.outside", "The isocentre of a beam lies outside every image.", \
      "Check that plan and images belong together, and that no slices are missing.") \
    X("beam.none", "A treatment plan has no external beam.", "Nothing.") \
    X("beam.position-assumed", "A treatment plan does not say how the patient lies.", \
      "Check the side a beam comes from.") \
    X("beam.distance-assumed", "A treatment plan does not say how far the source is.", \
      "The line begins at an assumed distance; its direction is right.") \
    X("beam.angle-assumed", "A treatment plan does not give the angle of the gantry.", \
      "Check the side a beam comes from.") \
    X("beam.moves", "Table or isocentre move during a beam.", "The beam is shown as it starts.") \
    X("beam.pitch", "The gantry is pitched, which is not regarded.", "The beam's direction is wrong by that angle.") \
    X("beam.arc", "The gantry turns during a beam.", \
      "The line is shown where it starts; start and stop are in the list of beams.") \
    X("beam.control-points", "A treatment plan says another number of control points than it has.", \
      "Those it has were taken; check the file.") \
    X("beam.frame-differs", "A treatment plan is in another frame of reference than the image.", \
      "Its beams may be shifted: check them.") \
    X("beam.from-tracks", "No beam is given; it was taken from the beam line of the tracks.", \
      "Its aperture is unknown.") \
    X("tracks.unsupported", "A track file is in a format this version does not read.", \
      "The rest is shown without it.") \
    X("tracks.unit-assumed", "The unit of a track file was decided by comparing it with the patient.", \
      "Give \"unit\" in plan.json.") \
    X("tracks.unit-doubtful", "The unit given for a track file does not suit the patient's size.", \
      "Check \"unit\" in plan.json.") \
    X("tracks.no-energy", "Tracks without an energy class.", "They are listed in the high class of their kind.") \
    X("tracks.zero-length", "Tracks of no length.", "They are left out.") \
    X("tracks.far", "Tracks that end further away than any treatment room.", \
      "They are left out; check the unit in plan.json.") \
    X("tracks.bad-lines", "Lines of a track file that are not a segment.", "They are left out; check the file.") \
    X("curve.unread", "A reference curve could not be read.", "Check the file; the rest of the plan is whole.") \
    X("preferences.unread", "A file of preferences could not be read.", \
      "Check the file; the rest of the plan is whole.") \
    X("preferences.colors", "Regions took colour and opacity from a file of preferences.", "Nothing.") \
    X("preferences.tissues", "Regions took tissue data from a table of tissues, by their names.", \
      "Check boron ratios and weights against the plan.") \
    X("preferences.map", "There are several colour maps.", "The first was taken; name the wanted one in plan.json.") \
    X("preferences.levels", "Contour levels are given by more than one file of preferences.", \
      "The first was used; keep one file.") \
    X("dicom.several-studies", "The DICOM files of the folder are of several studies.", \
      "Check that all are of one patient; keep one plan a folder.") \
    X("geometry.frames-differ", "Parts of the plan have different frames of reference.", \
      "Check that they fit; register the images and export again.") \
    X("region.image-chosen", "The image that contours were drawn on is not here, or not named.", \
      "Check that the regions fit the image; put the series they were drawn on into the folder.") \
    X("geometry.apart", "Two parts of the plan do not overlap anywhere.", \
      "One of them may be flipped, shifted or of another patient.") \
    X("write.does-not-fit", "A part of another patient or frame of reference was not written.", \
      "Convert the parts of each patient and frame apart.") \
    X("write.labels-cleared", "Voxels of a label map that belong to no region were not written.", \
      "Nothing; no region loses a voxel.") \
    X("header.unknown-key", "A header has keys that are not known.", "They are ignored.") \
    X("header.bad-number", "A header has a value that is not a number.", "It is ignored.")
