import { useEffect } from "preact/hooks";
import type { Pictured } from "../../app/library";
import type { Page } from "../../app/page";
import { Icon } from "../ui/icon";

/** A small picture, or an icon while there is none. A new `version` requests a new picture under the same name. */
export function Thumbnail({
  page,
  of,
  version = 0,
  size = 72,
}: {
  page: Page;
  of: Pictured;
  version?: number;
  size?: number;
}) {
  const { library } = page.editor;
  const { value: picture } = library.picture(of, version);
  useEffect(() => library.show(of, version), [JSON.stringify(of), version]);
  if (picture === null || picture === "none")
    return (
      <span
        class={`thumbnail ${picture === null ? "busy" : ""}`}
        style={{ width: `${size}px`, height: `${size}px` }}
      >
        <Icon name="model" size={size / 2} />
      </span>
    );
  return <img class="thumbnail" src={picture} width={size} height={size} alt="" draggable={false} />;
}
